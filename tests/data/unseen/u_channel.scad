// U-channel of folded sheet, millimetres. The web lies in the plane z = 0 along x; one side is
// higher than the other and notched, the web has an oblong hole near one end: no symmetry.
length = 74;
width = 38;
thickness = 5;
high_side = 32;
low_side = 18;
bend = 5;          // inner radius of the folds
hole_d = 14;
hole_x = [12, 24]; // ends of the oblong hole, from the middle
notch = [22, 14];  // along x, from the upper edge down
$fn = 48;

module profile() {
  difference() {
    union() {
      translate([-width / 2, 0]) square([width, thickness + bend]);
      translate([-width / 2, 0]) square([thickness, high_side]);
      translate([width / 2 - thickness, 0]) square([thickness, low_side]);
    }
    hull() for (side = [-1, 1])
      translate([side * (width / 2 - thickness - bend), thickness + bend]) circle(bend);
    for (side = [-1, 1]) translate([side * width / 2, 0]) difference() {
      square(2 * thickness, center = true);
      translate([-side * thickness, thickness]) circle(thickness);
    }
  }
}

difference() {
  rotate([90, 0, 90]) linear_extrude(length, center = true) profile();
  hull() for (x = hole_x) translate([x, 0, -1]) cylinder(d = hole_d, h = thickness + 2);
  translate([-length / 2 + 8, -width / 2 - 1, high_side - notch[1]])
    cube([notch[0], thickness + 2, notch[1] + 1]);
}
