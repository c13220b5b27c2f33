// Saddle clamp for a 34 mm pipe, millimetres. The pipe lies along y; the feet's lower faces are the
// plane z = 0, and the clamp turns onto itself by 180° about z.
bore_d = 34;
wall = 5;
width = 28;       // along the pipe
foot_length = 19; // beyond the arch
foot_thickness = 5;
hole_d = 8;
rib = 6;          // thickness of the gussets between arch and feet
$fn = 72;

outer_d = bore_d + 2 * wall;
reach = outer_d / 2 + foot_length;

module along_pipe(length) rotate([90, 0, 0]) cylinder(d = outer_d, h = length, center = true);

module foot() translate([0, -width / 2, 0]) cube([reach, width, foot_thickness]);

module gusset() rotate([90, 0, 0]) linear_extrude(rib, center = true)
  polygon([[outer_d / 2 - wall, 0], [reach - 4, foot_thickness], [outer_d / 2 - 7, 15]]);

module half() {
  difference() {
    union() {
      foot();
      gusset();
    }
    // On either side of the gusset.
    for (side = [-1, 1])
      translate([outer_d / 2 + foot_length / 2, side * (rib / 2 + 5), -1])
        cylinder(d = hole_d, h = foot_thickness + 2);
  }
}

difference() {
  union() {
    along_pipe(width);
    half();
    rotate([0, 0, 180]) half();
  }
  rotate([90, 0, 0]) cylinder(d = bore_d, h = width + 2, center = true);
  translate([-reach - 1, -width, -outer_d]) cube([2 * reach + 2, 2 * width, outer_d]);
}
