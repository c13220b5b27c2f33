// Three-way pipe, millimetres. The run lies along x, the branch points along +y, and the axes cross
// in the origin.
outer_d = 34;
bore_d = 24;
run_length = 62;
branch_length = 31;  // from the run's axis to the branch's end
$fn = 64;

module run(d, length) rotate([0, 90, 0]) cylinder(d = d, h = length, center = true);
module branch(d, length) rotate([-90, 0, 0]) cylinder(d = d, h = length);

difference() {
  union() {
    run(outer_d, run_length);
    branch(outer_d, branch_length);
  }
  run(bore_d, run_length + 2);
  branch(bore_d, branch_length + 1);
}
