/* The files that a scene names: kept inside its folder, and named relative to it. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "shape/scene.h"

/* The folder of a path, "." where it names none; the caller frees it. NULL where memory is out. */
static char *folder_of(const char *path)
{
    const char *slash = strcmp(path, "-") ? strrchr(path, '/') : NULL;
    size_t length = !slash ? 0 : slash == path ? 1 : (size_t)(slash - path);
    char *folder = calloc(length + 2, 1);
    if (folder)
        memcpy(folder, length ? path : ".", length ? length : 1);
    return folder;
}

static char *join(const char *folder, const char *file)
{
    size_t room = strlen(folder) + strlen(file) + 2;
    char *path = malloc(room);
    if (path && (*file == '/' || !strcmp(folder, ".")))
        snprintf(path, room, "%s", file);
    else if (path)
        snprintf(path, room, "%s%s%s", folder, folder[strlen(folder) - 1] == '/' ? "" : "/", file);
    return path;
}

static bool climbs(const char *file)
{
    for (const char *part = file;; part++) {
        size_t length = strcspn(part, "/");
        if (length == 2 && part[0] == '.' && part[1] == '.')
            return true;
        part += length;
        if (!*part)
            return false;
    }
}

static bool lies_in(const char *folder, const char *path)
{
    size_t length = strlen(folder);
    if (length == 1) /* the root */
        return true;
    return !strncmp(folder, path, length) && path[length] == '/';
}

/* Whether what path leads to, through all links, lies in the folder. */
static shape_status check_inside(const char *folder, const char *path, const char *file, shape_error *error)
{
    char *real_folder = realpath(folder, NULL), *real_path = realpath(path, NULL);
    shape_status status = SHAPE_OK;
    if (!real_folder || !real_path)
        status = shape_error_set(error, SHAPE_ERROR_IO, "%s: cannot open: %s", path, strerror(errno));
    else if (!lies_in(real_folder, real_path))
        status = shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                 "\"%s\" is a link out of the scene's folder (put the file there, or give "
                                 "--allow-outside where you trust the scene)",
                                 file);
    free(real_folder);
    free(real_path);
    return status;
}

static shape_status check_file(const char *folder, const char *path, const char *file, bool allow_outside,
                               shape_error *error)
{
    struct stat info;
    if (stat(path, &info))
        return shape_error_set(error, SHAPE_ERROR_IO, "%s: cannot open: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return shape_error_set(error, SHAPE_ERROR_IO, "%s: not a file (name a file)", path);
    return allow_outside ? SHAPE_OK : check_inside(folder, path, file, error);
}

shape_status shape_scene_find_file(const char *scene_path, const char *file, bool allow_outside, char **path,
                                   shape_error *error)
{
    if (!*file || !strcmp(file, "-"))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "\"%s\" is no file's name", file);
    if (!allow_outside && (*file == '/' || climbs(file)))
        return shape_error_set(
            error, SHAPE_ERROR_ARGUMENT,
            "\"%s\" leaves the scene's folder (put the file there, or give --allow-outside "
            "where you trust the scene)",
            file);
    char *folder = folder_of(scene_path), *joined = folder ? join(folder, file) : NULL;
    shape_status status =
        joined ? check_file(folder, joined, file, allow_outside, error) : shape_error_memory(error);
    free(folder);
    if (status)
        free(joined);
    else
        *path = joined;
    return status;
}

/* The real path of a file's folder, with its own name behind it: a link is named, not followed. */
static shape_status real_place(const char *path, char **folder, const char **base, shape_error *error)
{
    char *named = folder_of(path);
    if (!named)
        return shape_error_memory(error);
    *folder = realpath(named, NULL);
    shape_status status =
        *folder ? SHAPE_OK
                : shape_error_set(error, SHAPE_ERROR_IO, "%s: cannot open: %s", named, strerror(errno));
    free(named);
    const char *slash = strrchr(path, '/');
    *base = slash ? slash + 1 : path;
    return status;
}

/* From folder `from` to folder `to`, both real: a "../" for each step up, then the way down, ending in '/' or empty. */
static char *way_between(const char *from, const char *to, bool *outside)
{
    size_t same = 0; /* up to there they agree in whole parts */
    for (size_t i = 0;; i++) {
        bool end_from = !from[i] || from[i] == '/', end_to = !to[i] || to[i] == '/';
        if (end_from && end_to)
            same = i;
        if (from[i] != to[i] || !from[i])
            break;
    }
    size_t steps = 0;
    for (const char *c = from + same; *c; c++)
        steps += *c == '/' && c[1];
    const char *down = to + same;
    down += *down == '/';
    char *way = calloc(3 * steps + strlen(down) + 2, 1);
    for (size_t i = 0; way && i < steps; i++)
        memcpy(way + 3 * i, "../", 3);
    if (way && *down) {
        memcpy(way + 3 * steps, down, strlen(down));
        way[3 * steps + strlen(down)] = '/';
    }
    *outside = steps > 0;
    return way;
}

shape_status shape_scene_relative(const char *scene_path, const char *path, char **file, bool *outside,
                                  shape_error *error)
{
    char *from = NULL, *to = NULL;
    const char *base, *scene_base;
    shape_status status = real_place(scene_path, &from, &scene_base, error);
    if (!status)
        status = real_place(path, &to, &base, error);
    char *way = status ? NULL : way_between(from, to, outside);
    if (!status) {
        *file = way ? malloc(strlen(way) + strlen(base) + 1) : NULL;
        if (*file)
            sprintf(*file, "%s%s", way, base);
        else
            status = shape_error_memory(error);
    }
    free(way);
    free(from);
    free(to);
    return status;
}
