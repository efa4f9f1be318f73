/* All generators that a scene may name. */
#include "cli_generator.h"

const cli_generator *const cli_generators[] = {&cli_gauss, &cli_meta, &cli_layer, &cli_lsys, &cli_mesh, NULL};
