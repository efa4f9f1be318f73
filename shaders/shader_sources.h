/* The shaders as text, embedded at build time (cmake/embed.cmake). */
#ifndef SHADER_SOURCES_H
#define SHADER_SOURCES_H

#include <stddef.h>

typedef struct shader_source {
    const char *name; /* path below shaders/ */
    const char *text;
} shader_source;

extern const shader_source shader_sources[];
extern const size_t shader_source_count;

#endif
