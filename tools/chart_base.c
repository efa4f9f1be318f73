/* What all parts of neph-chart use: the clock, digests of what a result depends on, files of the folder. */
#include <sys/types.h>

#include <sha2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "chart.h"
#include "cli.h"

double chart_seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void chart_digest(const void *bytes, size_t count, char digest[CHART_DIGEST + 1])
{
    uint8_t whole[SHA256_DIGEST_LENGTH];
    SHA2_CTX context;
    SHA256Init(&context);
    SHA256Update(&context, bytes, count);
    SHA256Final(whole, &context);
    for (int i = 0; i < CHART_DIGEST / 2; i++)
        snprintf(digest + 2 * i, 3, "%02x", whole[i]);
}

char *chart_path(const chart_plan *plan, const char *name)
{
    size_t room = strlen(plan->folder) + strlen(name) + 2;
    char *path = malloc(room);
    if (!path)
        cli_fail("not enough memory");
    snprintf(path, room, "%s/%s", plan->folder, name);
    return path;
}
