// A machine foot: a trapezoid with a bolt of steel through it, in millimeters.
h = 10;                          // size of the cells before they are halved

Point(1) = {-60,  0, 0, h};
Point(2) = { 60,  0, 0, h};
Point(3) = { 40, 40, 0, h};
Point(4) = {-40, 40, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};

Point(5) = {  0, 22, 0};         // the axis of the bolt
Point(6) = { 10, 22, 0, h/2};    // its surface, bonded to the foot
Point(7) = {-10, 22, 0, h/2};
Circle(5) = {6, 5, 7};
Circle(6) = {7, 5, 6};
Point(8) = {  4, 22, 0, h/2};    // and its core, by which it is moved
Point(9) = { -4, 22, 0, h/2};
Circle(7) = {8, 5, 9};
Circle(8) = {9, 5, 8};

Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {5, 6};
Curve Loop(3) = {7, 8};
Plane Surface(1) = {1, 2};
Plane Surface(2) = {2, 3};

// Boundaries 1 to 4, and materials 1 and 2, with their names.
Physical Curve("base", 1)   = {1};
Physical Curve("top", 2)    = {3};
Physical Curve("core", 3)   = {7, 8};
Physical Curve("sides", 4)  = {2, 4};
Physical Surface("foot", 1) = {1};
Physical Surface("bolt", 2) = {2};

Mesh.RecombineAll = 1;           // quadrilaterals
Mesh.SubdivisionAlgorithm = 1;   // and nothing else
