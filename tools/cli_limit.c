/* How much a generator may make: as much as its program allows, and within a scene what is left of the scene's limit. */
#include "cli_generator.h"

static size_t most = SIZE_MAX;

size_t cli_generator_limit(size_t own)
{
    return own < most ? own : most;
}

void cli_generator_set_limit(size_t limit)
{
    most = limit;
}
