/* neph-vdb, the way in: a volume becomes a .neph of few primitives. */
#ifndef NEPHELE_CLI_VDB_FIT_H
#define NEPHELE_CLI_VDB_FIT_H

#include "cli.h"

typedef struct cli_vdb_fit_settings {
    int64_t primitives, cells;
    double error;
    int model; /* 0 uniform, 1 spheroid */
    bool primitives_given, error_given;
} cli_vdb_fit_settings;

extern cli_vdb_fit_settings cli_vdb_fit_values;

/* Reads the volume by the options of cli_volume.h, from the file or, where bytes is not NULL, from these; fits it, writes
 * a .neph and says how good it is. */
void cli_vdb_fit(const cli_common *common, const char *path, const unsigned char *bytes, size_t size);

#endif
