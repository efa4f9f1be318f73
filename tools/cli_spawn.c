/* A generator run as a program of its own: those that load libraries which are slow to start. */
#include <errno.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli_generator.h"
#include "shape/neph.h"

extern char **environ;

enum { PATH_ROOM = 4096, MAX_ARGUMENTS = 360, MAX_OUTPUT = 0x40000000 };

const char *cli_find_program(const char *name, char *path, size_t room)
{
    ssize_t length = readlink("/proc/self/exe", path, room - 1);
    if (length <= 0)
        return name;
    path[length] = 0;
    char *slash = strrchr(path, '/');
    size_t used = slash ? (size_t)(slash - path) + 1 : 0;
    if (used + strlen(name) >= room)
        return name;
    memcpy(path + used, name, strlen(name) + 1);
    return access(path, X_OK) ? name : path;
}

/* The command line. Texts of "--name=value" stand in *texts, which the caller frees after the array. */
static char **build_arguments(const char *program, const char *input, const shape_scene_options *options,
                              char **texts)
{
    size_t room = 1;
    for (size_t i = 0; i < options->count; i++)
        room += strlen(options->items[i].name) + 4 +
                (options->items[i].text ? strlen(options->items[i].text) : 0);
    char **arguments = calloc(MAX_ARGUMENTS + 6, sizeof *arguments), *to = *texts = malloc(room);
    if (!arguments || !to)
        cli_fail("not enough memory");
    size_t count = 0;
    arguments[count++] = (char *)program;
    arguments[count++] = (char *)"-q";
    for (size_t i = 0; i < options->count && count < MAX_ARGUMENTS; i++) {
        const char *text = options->items[i].text;
        arguments[count++] = to;
        to += 1 + sprintf(to, "--%s%s%s", options->items[i].name, text ? "=" : "", text ? text : "");
    }
    arguments[count++] = (char *)"--";
    if (input)
        arguments[count++] = (char *)input;
    return arguments;
}

/* Runs it with its outputs in two files, and returns its exit status. */
static int run(const char *program, char **arguments, FILE *out, FILE *err)
{
    posix_spawn_file_actions_t actions;
    pid_t child = -1;
    int status = -1;
    if (posix_spawn_file_actions_init(&actions))
        cli_fail("not enough memory");
    int code = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
    code = code ? code : posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    code = code ? code : posix_spawn_file_actions_adddup2(&actions, fileno(err), STDERR_FILENO);
    code = code ? code : posix_spawnp(&child, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (code)
        cli_fail("cannot run %s: %s (it belongs beside this program, or into PATH)", program, strerror(code));
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    return status;
}

/* Its mistakes become ours, a line each, without its name before them. */
static void forward_errors(const char *name, FILE *err)
{
    char line[1024];
    size_t length = strlen(name);
    bool any = false;
    rewind(err);
    for (; fgets(line, sizeof line, err); any = true) {
        line[strcspn(line, "\n")] = 0;
        bool named = !strncmp(line, name, length) && !strncmp(line + length, ": ", 2);
        cli_error("%s", named ? line + length + 2 : line);
    }
    if (!any)
        cli_error("%s ended without a word", name);
    exit(CLI_FAILED);
}

static shape_set *read_output(const char *name, FILE *out)
{
    shape_error error;
    shape_set *set;
    long size = fseek(out, 0, SEEK_END) ? -1 : ftell(out);
    if (size < 0 || size > MAX_OUTPUT)
        cli_fail("%s made more than can be read", name);
    unsigned char *bytes = malloc((size_t)size + 1);
    if (!bytes)
        cli_fail("not enough memory");
    rewind(out);
    if (fread(bytes, 1, (size_t)size, out) != (size_t)size)
        cli_fail("cannot read what %s wrote", name);
    cli_check(shape_neph_decode(bytes, (size_t)size, &set, &error), &error);
    free(bytes);
    return set;
}

shape_set *cli_generator_spawn(const cli_generator *generator, const char *input,
                               const shape_scene_options *options)
{
    char path[PATH_ROOM], *texts;
    const char *program = cli_find_program(generator->name, path, sizeof path);
    char **arguments = build_arguments(program, input, options, &texts);
    FILE *out = tmpfile(), *err = tmpfile();
    if (!out || !err)
        cli_fail("no temporary file: %s", strerror(errno));
    int status = run(program, arguments, out, err);
    free(arguments);
    free(texts);
    if (!WIFEXITED(status) || WEXITSTATUS(status))
        forward_errors(generator->name, err);
    shape_set *set = read_output(generator->name, out);
    fclose(out);
    fclose(err);
    return set;
}
