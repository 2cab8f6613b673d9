// Light of four numbers, each 1 in the cube's own light.
struct UpglowLight {
    red: f32,
    green: f32,
    blue: f32,
    ultraviolet: f32,
}

// How a material acts on light.
struct UpglowMatrix {
    red: UpglowLight, // how much of each number that arrives leaves as red
    green: UpglowLight, // as green
    blue: UpglowLight, // as blue
    ultraviolet: UpglowLight, // as ultraviolet
}

// A row of a corner's matrix, times its weight.
fn upglow_corner_row(corner: UpglowCorner, number: i32) -> UpglowLight {
    let texel: vec4f = upglow_node(4 * corner.red + number, corner.row);
    var row: UpglowLight;
    row.red = corner.weight * texel.x;
    row.green = corner.weight * texel.y;
    row.blue = corner.weight * texel.z;
    row.ultraviolet = corner.weight * texel.w;
    return row;
}

fn upglow_row(m: UpglowMaterial, number: i32) -> UpglowLight {
    let a: UpglowLight = upglow_corner_row(m.a, number);
    let b: UpglowLight = upglow_corner_row(m.b, number);
    let c: UpglowLight = upglow_corner_row(m.c, number);
    let d: UpglowLight = upglow_corner_row(m.d, number);
    var row: UpglowLight;
    row.red = a.red + b.red + c.red + d.red;
    row.green = a.green + b.green + c.green + d.green;
    row.blue = a.blue + b.blue + c.blue + d.blue;
    row.ultraviolet = a.ultraviolet + b.ultraviolet + c.ultraviolet + d.ultraviolet;
    return row;
}

// The matrix of a linear color in the cube's RGB space.
fn upglow_matrix(rgb: vec3f) -> UpglowMatrix {
    let m: UpglowMaterial = upglow_look_up(rgb, UPGLOW_RESOLUTION);
    var made: UpglowMatrix;
    made.red = upglow_row(m, 0);
    made.green = upglow_row(m, 1);
    made.blue = upglow_row(m, 2);
    made.ultraviolet = upglow_row(m, 3);
    return made;
}

fn upglow_sum(row: UpglowLight, light: UpglowLight) -> f32 {
    return row.red * light.red + row.green * light.green + row.blue * light.blue
        + row.ultraviolet * light.ultraviolet;
}

// What leaves a diffuse surface that is lit by this light.
fn upglow_relit(m: UpglowMatrix, light: UpglowLight) -> UpglowLight {
    var leaves: UpglowLight;
    leaves.red = upglow_sum(m.red, light);
    leaves.green = upglow_sum(m.green, light);
    leaves.blue = upglow_sum(m.blue, light);
    leaves.ultraviolet = upglow_sum(m.ultraviolet, light);
    return leaves;
}
