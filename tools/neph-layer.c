/* neph-layer: a bounded noise volume - stratus, stratocumulus, fog, or any other layer, box or ball of noise. */
#include "cli_generator.h"

static const cli_help own_help[] = {{"model", "density model [layer]"},
                                    {"extinction", "extinction at density 1, 1/m [2; presets 0.04 to 0.06]"},
                                    {0}};

static const cli_program program = {
    .name = "neph-layer",
    .arguments = "",
    .about =
        "Makes a bounded noise volume: noise through two thresholds, inside a box, a ball or two altitudes.",
    .examples = "  neph-layer --preset stratus -o stratus.neph\n"
                "  neph-layer --bounds sphere --extent 10,10,10 --noise perlin --falloff 0.8 | neph-view -\n"
                "  neph-layer --preset stratocumulus --coverage 0.5 --seed 4 -o patches.neph\n",
    .min_arguments = 0,
    .max_arguments = 0,
    .help = own_help};

int main(int argc, char **argv)
{
    return cli_generator_main(&program, &cli_layer, cli_layer.make, argc, argv);
}
