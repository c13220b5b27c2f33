// Flanged ring, millimetres. Its axis is z; the flange's free face is the plane z = 0.
flange_d = 56;
flange_thickness = 6;
hub_d = 40;
bore_d = 30;
height = 26;
fillet = 3;  // between flange and hub
$fn = 72;

rotate_extrude() difference() {
  union() {
    translate([bore_d / 2, 0]) square([(flange_d - bore_d) / 2, flange_thickness]);
    translate([bore_d / 2, 0]) square([(hub_d - bore_d) / 2, height]);
    translate([hub_d / 2, flange_thickness]) square(fillet);
  }
  translate([hub_d / 2 + fillet, flange_thickness + fillet]) circle(fillet, $fn = 16);
}
