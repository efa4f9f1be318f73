/* neph-meta: metaball cumuli, a few balls that flow into one another (Jiménez 2018 section 3.6.3). */
#include "cli_generator.h"

static const cli_help own_help[] = {{"model", "density model [metaball]"}, {0}};

static const cli_program program = {.name = "neph-meta",
                                    .arguments = "",
                                    .about = "Makes a metaball cumulus: balls of random radius at normally "
                                             "distributed places over a flat base, which\n"
                                             "their common field joins into one body.",
                                    .examples =
                                        "  neph-meta -o puff.neph\n"
                                        "  neph-meta --count 12 --sigma 6,2,3 --seed 4 | neph-view -\n"
                                        "  neph-meta --edge 2 --extinction 4 -o dense.neph\n",
                                    .min_arguments = 0,
                                    .max_arguments = 0,
                                    .help = own_help};

int main(int argc, char **argv)
{
    return cli_generator_main(&program, &cli_meta, cli_meta.make, argc, argv);
}
