/* The file that is shown: a .neph as it stands, a grammar as neph-lsys derives it. */
#include "source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "shape/file.h"
#include "shape/neph.h"
#include "shape/turtle.h"

enum { MAX_SET_FILE = 0x40000000 };

/* Whether a file is a grammar: its name says so, or its bytes are text. A .neph begins with a byte that no text has. */
static bool is_grammar(const char *path, const unsigned char *bytes, size_t size)
{
    const char *dot = strrchr(path, '.');
    if (size && bytes[0] == 0x89)
        return false;
    if (dot && !strcmp(dot, ".lsys"))
        return true;
    if (dot && !strcmp(dot, ".neph"))
        return false;
    for (size_t i = 0; i < size && i < 64; i++)
        if (bytes[i] < 32 && bytes[i] != '\n' && bytes[i] != '\t' && bytes[i] != '\r')
            return false;
    return size > 0;
}

static void list_mistakes(const char *shown, const shape_mistakes *found, char *text, size_t room)
{
    size_t used = 0;
    text[0] = 0;
    for (int i = 0; i < found->count && used + 1 < room; i++) {
        int length = snprintf(text + used, room - used, "%s%s:%d:%d: %s", i ? "\n" : "", shown,
                              found->items[i].line, found->items[i].column, found->items[i].text);
        used += length > 0 ? (size_t)length : 0;
    }
}

static shape_status grow(const shape_grammar *grammar, const shape_derive_options *options, const char *path,
                         const char *shown, shape_set *set, shape_error *error)
{
    char name[SHAPE_NAME_MAX + 1];
    shape_derive_counts counts;
    cli_bare_name(path, "grammar", name);
    shape_status status = shape_set_add_cloud(set, name, NULL, error);
    if (!status)
        status = shape_grammar_grow(grammar, options, shape_set_list(set, 0), &counts, error);
    if (!status && !counts.primitives)
        status = shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the derived string sets no puff", shown);
    if (status)
        return status;
    shape_cloud *cloud = &set->clouds[0];
    cloud->field = shape_grammar_get_settings(grammar)->field;
    cloud->medium = shape_grammar_get_settings(grammar)->medium;
    cloud->seed = cloud->field.seed = options->seed;
    return shape_cloud_choose_noise_scale(cloud, shape_set_list(set, 0), error);
}

static shape_status derive(const shape_grammar *grammar, const view_generator *generator, const char *path,
                           const char *shown, view_contents *contents, shape_error *error)
{
    shape_derive_options options = shape_derive_defaults(grammar);
    options.seed = generator->seed;
    if (generator->own_iterations)
        options.iterations = generator->iterations;
    if (generator->own_angle) {
        options.angle.low = generator->angle[0];
        options.angle.high = generator->angle[1];
    }
    contents->grammar = true;
    contents->used = *generator;
    contents->used.iterations = options.iterations;
    contents->used.angle[0] = options.angle.low;
    contents->used.angle[1] = options.angle.high;
    contents->set = shape_set_create(error);
    if (!contents->set)
        return SHAPE_ERROR_MEMORY;
    shape_status status = grow(grammar, &options, path, shown, contents->set, error);
    if (status) {
        shape_set_destroy(contents->set);
        contents->set = NULL;
    }
    return status;
}

static shape_status read_grammar(const char *path, const char *shown, const unsigned char *bytes, size_t size,
                                 const view_generator *generator, view_contents *contents, char *mistakes,
                                 size_t room, shape_error *error)
{
    shape_mistakes *found = malloc(sizeof *found);
    shape_grammar *grammar;
    if (!found)
        return shape_error_memory(error);
    shape_status status = shape_grammar_parse(bytes, size, shown, &grammar, found, error);
    if (status == SHAPE_ERROR_FORMAT)
        list_mistakes(shown, found, mistakes, room);
    free(found);
    if (status)
        return status;
    status = derive(grammar, generator, path, shown, contents, error);
    shape_grammar_destroy(grammar);
    return status;
}

shape_status view_source_decode(const char *path, const unsigned char *bytes, size_t size,
                                const view_generator *generator, view_contents *contents, char *mistakes,
                                size_t room, shape_error *error)
{
    const char *shown = strcmp(path, "-") ? path : "standard input";
    shape_status status;
    memset(contents, 0, sizeof *contents);
    mistakes[0] = 0;
    if (is_grammar(path, bytes, size)) {
        status = read_grammar(path, shown, bytes, size, generator, contents, mistakes, room, error);
    } else {
        status = shape_neph_decode(bytes, size, &contents->set, error);
        if (status) {
            shape_error inner = *error;
            shape_error_set(error, status, "%s: %.400s", shown, inner.text);
        }
    }
    if (status && !mistakes[0])
        snprintf(mistakes, room, "%s", error->text);
    return status;
}

shape_status view_source_read(const char *path, const view_generator *generator, view_contents *contents,
                              char *mistakes, size_t room, shape_error *error)
{
    unsigned char *bytes;
    size_t size;
    memset(contents, 0, sizeof *contents);
    shape_status status = shape_file_read(path, MAX_SET_FILE, &bytes, &size, error);
    if (status) {
        snprintf(mistakes, room, "%s", error->text);
        return status;
    }
    status = view_source_decode(path, bytes, size, generator, contents, mistakes, room, error);
    free(bytes);
    return status;
}
