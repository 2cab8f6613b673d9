// One of the four materials that a color is mixed of.
struct UpglowCorner {
    weight: f32, // its share, 0 to 1
//@if place
    red: i32, // number of its node along red
    row: i32, // along green, and along blue times the nodes of an axis
//@end
//@if material
    edge_nm: f32, // where its reflectance is steepest
    level: f32, // the parabola there
    rise: f32, // the parabola's coefficient of the distance from there, 1/nm
    bend: f32, // and of its square, 1/nm²
//@end
//@if js
    node: i32, // number of its node in the cube, red fastest
//@end
//@if concentrated
    concentration: f32, // 0 where nothing fluoresces
    returned_nm: f32, // what fluorescence gives back of light that is 1 at every wavelength
//@end
//@if dyes
    dye: i32, // number of the first of its two dyes
    second: f32, // share of the second, the next in the ring
//@end
//@if film
    density: f32, // optical density of its first dye, 0 where nothing fluoresces
    second_density: f32, // of its second dye
    dye: i32, // number of the first dye
    second_dye: i32, // of the second
//@end
//@if bells
    absorption_nm: f32, // the absorption's peak
    emission_nm: f32, // the emission's peak
//@end
}

// The material of a color, ready to evaluate.
struct UpglowMaterial {
    a: UpglowCorner,
    b: UpglowCorner,
    c: UpglowCorner,
    d: UpglowCorner,
}

// A number within two bounds; the lower one for what is no number.
fn upglow_within(value: f32, low: f32, high: f32) -> f32 {
//@if osl
    // Here what is no number is greater than all.
    if (isnan(value)) {
        return low;
    }
//@end
    if (value > low) {
        return min(value, high);
    }
    return low;
}

fn upglow_corner(weight: f32, red: i32, row: i32) -> UpglowCorner {
//@if material
    let parabola: vec4f = upglow_node(2 * red, row);
//@end
    var corner: UpglowCorner;
    corner.weight = weight;
//@if place
    corner.red = red;
    corner.row = row;
//@end
//@if material
    corner.edge_nm = parabola.x;
    corner.level = parabola.y;
    corner.rise = parabola.z;
    corner.bend = parabola.w;
//@end
//@if js
    corner.node = row * UPGLOW_RESOLUTION + red;
//@end
//@if fluorescent
    let numbers: vec4f = upglow_node(2 * red + 1, row);
//@end
//@if concentrated
    corner.concentration = numbers.y;
    corner.returned_nm = numbers.z;
//@end
//@if dyes
    corner.dye = i32(numbers.w);
    corner.second = numbers.x;
//@end
//@if film
    corner.density = numbers.y;
    corner.second_density = numbers.x;
    corner.dye = i32(numbers.w);
    corner.second_dye = i32(numbers.z);
//@end
//@if bells
    corner.absorption_nm = numbers.w;
    corner.emission_nm = numbers.x;
//@end
    return corner;
}

// The material of a linear color in the cube's RGB space. What is outside 0 to 1 counts as the
// nearer end, and what is no number as 0.
//@if material
fn upglow_look_up(rgb: vec3f) -> UpglowMaterial {
    let n: i32 = UPGLOW_RESOLUTION;
//@end
//@if place
fn upglow_look_up(rgb: vec3f, n: i32) -> UpglowMaterial {
//@end
    let red: f32 = f32(n - 1) * upglow_within(rgb[0], 0.0, 1.0);
    let green: f32 = f32(n - 1) * upglow_within(rgb[1], 0.0, 1.0);
    let blue: f32 = f32(n - 1) * upglow_within(rgb[2], 0.0, 1.0);
    let i: i32 = min(i32(red), n - 2);
    let j: i32 = min(i32(green), n - 2);
    let k: i32 = min(i32(blue), n - 2);
    let r: f32 = red - f32(i);
    let g: f32 = green - f32(j);
    let b: f32 = blue - f32(k);
    // The color's tetrahedron goes from the dark corner of its cell along the axis of the greatest
    // fraction, and comes to the bright one along that of the least.
    var first_red: i32 = 0;
    var first_row: i32 = 0;
    if (r >= g && r >= b) {
        first_red = 1;
    } else if (g >= b) {
        first_row = 1;
    } else {
        first_row = n;
    }
    var last_red: i32 = 0;
    var last_row: i32 = 0;
    if (r < g && r < b) {
        last_red = 1;
    } else if (g < b) {
        last_row = 1;
    } else {
        last_row = n;
    }
    let greatest: f32 = max(max(r, g), b);
    let middle: f32 = max(min(r, g), min(max(r, g), b));
    let least: f32 = min(min(r, g), b);
    let row: i32 = k * n + j;
    var m: UpglowMaterial;
    m.a = upglow_corner(1.0 - greatest, i, row);
    m.b = upglow_corner(greatest - middle, i + first_red, row + first_row);
    m.c = upglow_corner(middle - least, i + 1 - last_red, row + n + 1 - last_row);
    m.d = upglow_corner(least, i + 1, row + n + 1);
    return m;
}
