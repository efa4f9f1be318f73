/* neph-mesh: a mesh becomes a cloud, an ellipsoid for each triangle (Jiménez 2018 section 3.6.4). */
#include "cli_mesh.h"

static const cli_program program = {
    .name = "neph-mesh",
    .arguments = "MESH",
    .about = "Makes a cloud of a mesh: decimates it and puts an ellipsoid on each triangle.\n"
             "MESH is an OBJ, PLY, STL, OFF, glTF or GLB file, or - for standard input.",
    .examples = "  neph-mesh examples/meshes/suzanne.obj -o suzanne.neph\n"
                "  neph-mesh --fit --fill 200 examples/meshes/suzanne.glb -o suzanne.neph\n"
                "  neph-mesh --size 100 --center --faces 700 model.stl | neph-view -\n",
    .min_arguments = 1,
    .max_arguments = 1};

int main(int argc, char **argv)
{
    return cli_generator_main(&program, &cli_mesh, cli_mesh_make, argc, argv);
}
