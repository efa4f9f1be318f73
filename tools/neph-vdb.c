/* neph-vdb: volumes to primitives. */
#include "cli.h"
#include "cli_vdb_fit.h"
#include "cli_volume.h"

static const cli_group groups[] = {{"Fit", cli_vdb_fit_options},
                                   {"Volumes (.vdb, raw)", cli_volume_options},
                                   {"Medium and place of volumes", cli_optics_options},
                                   {0}};

static const cli_program program = {
    .name = "neph-vdb",
    .arguments = "IN.vdb | IN.raw",
    .about = "Makes a cloud of few spheres and ellipsoids of an OpenVDB or raw float volume.",
    .examples = "  neph-vdb smoke.vdb -o smoke.neph --primitives 100\n"
                "  neph-vdb scan.vdb -o scan.neph --error 0.1 --grid density\n",
    .min_arguments = 1,
    .max_arguments = 1,
    .groups = groups};

int main(int argc, char **argv)
{
    cli_common common;
    cli_parse(&program, argc, argv, &common);
    if (!cli_is_volume(common.arguments[0]))
        cli_fail("%s: no volume (.vdb, or a raw one)", common.arguments[0]);
    cli_vdb_fit(&common, common.arguments[0]);
    return cli_finish(&common);
}
