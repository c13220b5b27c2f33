// Hexagon bolt in the manner of M16 × 50, millimetres, without its thread. Its axis is z; the head
// rests on the plane z = 0 from above.
across_flats = 24;
head_height = 10;
shank_d = 16;
shank_length = 50;
tip_chamfer = 1.5;
$fn = 72;  // a multiple of 6: the shank turns onto itself with the head

across_corners = across_flats / cos(30);

module head()
  intersection() {
    cylinder(d = across_corners, h = head_height, $fn = 6);
    // The 30° chamfer of the head's corners.
    cylinder(d1 = across_flats + 2 * head_height / tan(30), d2 = 0.95 * across_flats,
             h = head_height);
  }

module shank()
  translate([0, 0, -shank_length]) {
    cylinder(d1 = shank_d - 2 * tip_chamfer, d2 = shank_d, h = tip_chamfer);
    translate([0, 0, tip_chamfer]) cylinder(d = shank_d, h = shank_length - tip_chamfer);
  }

union() {
  head();
  shank();
}
