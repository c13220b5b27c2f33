// 90° pipe elbow, millimetres. The two legs lie along +x and +y; their axes cross in the origin.
outer_d = 32;
bore_d = 24;
leg_length = 44;   // from the origin to a leg's end
bend_radius = 24;  // of the centre line
$fn = 48;

module leg(d, overshoot)
  translate([bend_radius, 0, 0]) rotate([0, 90, 0])
    cylinder(d = d, h = leg_length - bend_radius + overshoot);

module bend(d)
  translate([bend_radius, bend_radius, 0]) rotate(180)
    rotate_extrude(angle = 90) translate([bend_radius, 0]) circle(d = d);

module tube(d, overshoot = 0) {
  bend(d);
  leg(d, overshoot);
  mirror([1, -1, 0]) leg(d, overshoot);
}

difference() {
  tube(outer_d);
  tube(bore_d, overshoot = 1);
}
