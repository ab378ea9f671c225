// A machine foot: a trapezoid with a bore, in meters.
h = 0.01;                        // size of the cells before they are halved

Point(1) = {-0.06, 0.00, 0, h};
Point(2) = { 0.06, 0.00, 0, h};
Point(3) = { 0.04, 0.04, 0, h};
Point(4) = {-0.04, 0.04, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};

Point(5) = { 0.00, 0.022, 0};    // the bore, radius 10 mm
Point(6) = { 0.01, 0.022, 0, h/2};
Point(7) = {-0.01, 0.022, 0, h/2};
Circle(5) = {6, 5, 7};
Circle(6) = {7, 5, 6};

Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {5, 6};
Plane Surface(1) = {1, 2};

// What the parameter file calls boundaries 1 to 4, and material 1.
Physical Curve("base", 1)   = {1};
Physical Curve("top", 2)    = {3};
Physical Curve("bore", 3)   = {5, 6};
Physical Curve("sides", 4)  = {2, 4};
Physical Surface("foot", 1) = {1};

Mesh.RecombineAll = 1;           // quadrilaterals
Mesh.SubdivisionAlgorithm = 1;   // and nothing else
