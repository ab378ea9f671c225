// A long cavern in rock salt under its overburden, half of it, in meters: y = 0
// is the surface of the ground.
near = 6;                            // size of the cells at the cavern, at the
surface = 40;                        // surface and far away, before they are
far = 120;                           // halved

Point(1) = {   0, -800, 0, far};     // base
Point(2) = {1200, -800, 0, far};
Point(3) = {1200, -250, 0, far};     // top of the salt
Point(4) = {1200,    0, 0, far};     // surface
Point(5) = {   0,    0, 0, surface};
Point(6) = {   0, -250, 0, 2*near};
Point(7) = {   0, -300, 0, near};    // roof of the cavern, 60 m wide, 40 m high
Point(8) = {  30, -320, 0, near};
Point(9) = {   0, -340, 0, near};    // its floor
Point(10) = {  0, -320, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Ellipse(7) = {7, 10, 8, 8};
Ellipse(8) = {8, 10, 8, 9};
Line(9) = {9, 1};
Line(10) = {6, 3};                   // top of the salt

Curve Loop(1) = {1, 2, -10, 6, 7, 8, 9};
Plane Surface(1) = {1};
Curve Loop(2) = {10, 3, 4, 5};
Plane Surface(2) = {2};

// Boundaries 1 to 5, materials 1 and 2.
Physical Curve("wall", 1)    = {7, 8};
Physical Curve("axis", 2)    = {5, 6, 9};
Physical Curve("base", 3)    = {1};
Physical Curve("side", 4)    = {2, 3};
Physical Curve("surface", 5) = {4};
Physical Surface("salt", 1)  = {1};
Physical Surface("overburden", 2) = {2};

Mesh.RecombineAll = 1;               // quadrilaterals
Mesh.SubdivisionAlgorithm = 1;       // and nothing else
