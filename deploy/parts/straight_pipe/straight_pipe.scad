// Straight pipe, millimetres. Its axis is z, its middle the origin.
outer_d = 30;
bore_d = 22;
length = 60;
$fn = 64;

difference() {
  cylinder(d = outer_d, h = length, center = true);
  cylinder(d = bore_d, h = length + 2, center = true);
}
