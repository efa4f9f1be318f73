/* neph-gauss: cumulus clouds out of normally distributed spheres (Jiménez 2018 section 3.6.1), one or a field. */
#include "cli_generator.h"

static const cli_program program = {
    .name = "neph-gauss",
    .arguments = "",
    .about = "Makes a cumulus: spheres at normally distributed places over a flat base, larger in the "
             "middle. Spheres of\n"
             "the core and spheres inside others are left out. With --field, the centres of the clouds keep "
             "their\n"
             "distance from one another and their bases one height.",
    .examples = "  neph-gauss -o cumulus.neph\n"
                "  neph-gauss --preset congestus --seed 7 | neph-view -\n"
                "  neph-gauss --preset humilis --field 40 --area 300,300 -o sky.neph\n",
    .min_arguments = 0,
    .max_arguments = 0};

int main(int argc, char **argv)
{
    return cli_generator_main(&program, &cli_gauss, cli_gauss.make, argc, argv);
}
