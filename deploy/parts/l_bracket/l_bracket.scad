// L-bracket, millimetres. The long leg lies along +x, the short one stands along +z; their outer
// faces meet in the y axis, y = 0 being the middle of the width.
long_leg = 60;
short_leg = 40;
width = 40;
thickness = 6;
fillet = 5;           // in the inner corner
corner = 6;           // radius of the legs' free corners
long_hole_d = 9;
long_hole_x = [24, 45];
short_hole_d = 12;
short_hole_z = 23;
$fn = 48;

module plate(length)
  linear_extrude(thickness) hull() {
    translate([0, -width / 2]) square([1, width]);
    for (side = [-1, 1])
      translate([length - corner, side * (width / 2 - corner)]) circle(corner);
  }

module inner_fillet()
  translate([thickness, width / 2, thickness]) rotate([90, 0, 0]) linear_extrude(width)
    difference() {
      translate([-1, -1]) square(fillet + 1);
      translate([fillet, fillet]) circle(fillet);
    }

difference() {
  union() {
    plate(long_leg);
    mirror([1, 0, -1]) plate(short_leg);
    inner_fillet();
  }
  for (x = long_hole_x)
    translate([x, 0, -1]) cylinder(d = long_hole_d, h = thickness + 2);
  translate([-1, 0, short_hole_z]) rotate([0, 90, 0]) cylinder(d = short_hole_d, h = thickness + 2);
}
