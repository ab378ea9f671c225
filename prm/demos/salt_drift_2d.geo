// A drift in rock salt, half of it, in meters: y from its floor upwards.
near = 1;                          // size of the cells at the drift, and at
far  = 12;                         // the outside, before they are halved

Point(1) = { 0, -40, 0, far};      // the outside
Point(2) = {45, -40, 0, far};
Point(3) = {45,  50, 0, far};
Point(4) = { 0,  50, 0, far};
Point(5) = { 0,   4, 0, near};     // crown
Point(6) = { 3, 2.5, 0, near};     // springing of the arch
Point(7) = { 3, 0.5, 0, near/2};   // foot of the rib, rounded
Point(8) = {2.5,  0, 0, near/2};
Point(9) = { 0,   0, 0, near};     // middle of the floor
Point(10) = {0, 0.25, 0};          // center of the arch, of radius 3.75
Point(11) = {2.5, 0.5, 0};

Line(1)   = {1, 2};
Line(2)   = {2, 3};
Line(3)   = {3, 4};
Line(4)   = {4, 5};
Circle(5) = {5, 10, 6};
Line(6)   = {6, 7};
Circle(7) = {7, 11, 8};
Line(8)   = {8, 9};
Line(9)   = {9, 1};

Curve Loop(1)    = {1, 2, 3, 4, 5, 6, 7, 8, 9};
Plane Surface(1) = {1};

// What the parameter file calls boundaries 1 to 5, and material 1.
Physical Curve("wall", 1)   = {5, 6, 7, 8};
Physical Curve("axis", 2)   = {4, 9};
Physical Curve("bottom", 3) = {1};
Physical Curve("side", 4)   = {2};
Physical Curve("top", 5)    = {3};
Physical Surface("salt", 1) = {1};

Mesh.RecombineAll = 1;             // quadrilaterals
Mesh.SubdivisionAlgorithm = 1;     // and nothing else
