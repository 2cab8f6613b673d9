//! How much of the chromaticity diagram a cube covers.

use crate::field::Field;

/// Least X + Y + Z of the colors that count, as in the paper's figure 1.
const BRIGHT: f64 = 1.5;

/// The area in (x, y) of the convex hull of a cube's chromaticities with X + Y + Z ≥ 1.5.
pub(super) fn bright_area(field: &Field) -> f64 {
    let bright = field.shown.iter().filter(|xyz| xyz.0.iter().sum::<f64>() >= BRIGHT);
    area(&convex_hull(bright.filter_map(|xyz| xyz.chromaticity()).collect()))
}

type Point = [f64; 2];

/// Twice the area of the triangle, positive if it turns left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The corners of the hull, counterclockwise: the lower chain, then the upper.
fn convex_hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    points.dedup();
    let mut hull = chain(points.iter().copied());
    hull.pop();
    hull.extend(chain(points.iter().rev().copied()));
    hull.pop();
    hull
}

fn chain(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut chain: Vec<Point> = Vec::new();
    for point in points {
        while let [.., a, b] = chain[..]
            && turn(a, b, point) <= 0.0
        {
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

fn area(polygon: &[Point]) -> f64 {
    let Some(&first) = polygon.first() else { return 0.0 };
    polygon.windows(2).map(|edge| turn(first, edge[0], edge[1])).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_square_with_points_inside_is_the_square() {
        let points: Vec<Point> =
            (0..25).map(|i| [f64::from(i % 5) * 0.5, f64::from(i / 5) * 0.5]).collect();
        let hull = convex_hull(points);
        assert_eq!(hull.len(), 4);
        assert_eq!(area(&hull), 4.0);
    }

    #[test]
    fn too_few_points_have_no_area() {
        assert_eq!(area(&convex_hull(Vec::new())), 0.0);
        assert_eq!(area(&convex_hull(vec![[0.3, 0.3]])), 0.0);
        assert_eq!(area(&convex_hull(vec![[0.3, 0.3], [0.4, 0.3]])), 0.0);
    }
}
