// Stepped shaft with a flange, millimetres. Its axis is z; any turn about it leaves it as it was.
// [diameter, length] from the bottom up.
steps = [[18, 28], [46, 7], [28, 22], [16, 18]];
chamfer = 1.5;  // at both ends of each step
$fn = 72;

module step(d, length)
  rotate_extrude() polygon([[0, 0], [d / 2 - chamfer, 0], [d / 2, chamfer],
                            [d / 2, length - chamfer], [d / 2 - chamfer, length], [0, length]]);

function height(i) = i == 0 ? 0 : height(i - 1) + steps[i - 1][1];

// Each step reaches into the next one, so that no chamfer cuts a groove between them.
union() for (i = [0 : len(steps) - 1]) {
  translate([0, 0, height(i)]) step(steps[i][0], steps[i][1]);
  if (i + 1 < len(steps))
    translate([0, 0, height(i + 1) - chamfer])
      cylinder(d = min(steps[i][0], steps[i + 1][0]), h = 2 * chamfer);
}
