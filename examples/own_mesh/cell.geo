// A cell that is no ball: an ellipsoid with a nucleus out of its middle. Lengths in µm.
//   gmsh -3 -format msh41 cell.geo -o cell.msh
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 1};
Dilate{{0, 0, 0}, {6, 4.5, 3}}{ Volume{1}; }
Sphere(2) = {1.5, 0, 0, 1.6};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume("nucleus") = {2};
Physical Volume("cytoplasm") = {3};
Mesh.MeshSizeMax = 1.4;
