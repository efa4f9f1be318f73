/* A program run for its output; both its streams go to files without a name, so that none can fill up and stop it. */
#include "run.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli_generator.h"

extern char **environ;

enum { MAX_OUTPUT = 0x40000000 };

struct view_run {
    pthread_mutex_t mutex;
    pid_t child; /* 0: none; under the mutex */
    atomic_bool cancelled;
};

view_run *view_run_create(void)
{
    view_run *run = calloc(1, sizeof *run);
    if (run)
        pthread_mutex_init(&run->mutex, NULL);
    return run;
}

void view_run_destroy(view_run *run)
{
    if (run)
        pthread_mutex_destroy(&run->mutex);
    free(run);
}

void view_run_cancel(view_run *run)
{
    pthread_mutex_lock(&run->mutex);
    atomic_store(&run->cancelled, true);
    if (run->child > 0)
        kill(run->child, SIGKILL); /* what it has written is thrown away */
    pthread_mutex_unlock(&run->mutex);
}

void view_run_begin(view_run *run)
{
    atomic_store(&run->cancelled, false);
}

bool view_run_is_cancelled(view_run *run)
{
    return run && atomic_load(&run->cancelled);
}

static void set_child(view_run *run, pid_t child)
{
    if (!run)
        return;
    pthread_mutex_lock(&run->mutex);
    run->child = child;
    if (child > 0 && atomic_load(&run->cancelled))
        kill(child, SIGKILL); /* it was cancelled before it had begun */
    pthread_mutex_unlock(&run->mutex);
}

/* Starts it; 0 or what went wrong. */
static int start(char **arguments, FILE *input, FILE *out, FILE *err, pid_t *child)
{
    char path[4096];
    const char *program = cli_find_program(arguments[0], path, sizeof path);
    posix_spawn_file_actions_t actions;
    int code = posix_spawn_file_actions_init(&actions);
    if (code)
        return code;
    code = input ? posix_spawn_file_actions_adddup2(&actions, fileno(input), STDIN_FILENO)
                 : posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
    code = code ? code : posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    code = code ? code : posix_spawn_file_actions_adddup2(&actions, fileno(err), STDERR_FILENO);
    code = code ? code : posix_spawnp(child, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return code;
}

/* Waits for its end without taking it off the list of processes first, so that nobody ends another by its number. */
static int wait_for(view_run *run, pid_t child)
{
    int status = -1;
    siginfo_t info;
    while (waitid(P_PID, (id_t)child, &info, WEXITED | WNOWAIT) < 0 && errno == EINTR)
        continue;
    set_child(run, 0);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    return status;
}

static shape_status read_all(FILE *file, unsigned char **bytes, size_t *size, shape_error *error)
{
    long length = fseek(file, 0, SEEK_END) ? -1 : ftell(file);
    if (length < 0 || length > MAX_OUTPUT)
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "it made more than can be read");
    *bytes = malloc((size_t)length + 1);
    if (!*bytes)
        return shape_error_memory(error);
    rewind(file);
    *size = fread(*bytes, 1, (size_t)length, file);
    (*bytes)[*size] = 0;
    if (*size == (size_t)length)
        return SHAPE_OK;
    free(*bytes);
    return shape_error_set(error, SHAPE_ERROR_IO, "its output cannot be read");
}

/* Its lines, without "name: " before each. */
static void take_mistakes(const char *name, FILE *err, char *mistakes, size_t room)
{
    char line[4096];
    size_t used = 0, length = strlen(name);
    mistakes[0] = 0;
    rewind(err);
    while (used + 1 < room && fgets(line, sizeof line, err)) {
        line[strcspn(line, "\n")] = 0;
        bool named = !strncmp(line, name, length) && !strncmp(line + length, ": ", 2);
        int more = snprintf(mistakes + used, room - used, "%s%s", used ? "\n" : "",
                            named ? line + length + 2 : line);
        used += more > 0 ? (size_t)more : 0;
    }
    if (!used)
        snprintf(mistakes, room, "%s ended without a word", name);
}

shape_status view_run_program(view_run *run, char **arguments, FILE *input, unsigned char **bytes,
                              size_t *size, char *mistakes, size_t room, shape_error *error)
{
    FILE *out = tmpfile(), *err = out ? tmpfile() : NULL;
    pid_t child = 0;
    shape_status status = SHAPE_OK;
    mistakes[0] = 0;
    int code = err ? start(arguments, input, out, err, &child) : errno;
    if (code) {
        status = shape_error_set(error, SHAPE_ERROR_SYSTEM,
                                 "cannot run %s: %s (it belongs beside this program, or into PATH)",
                                 arguments[0], strerror(code));
    } else {
        set_child(run, child);
        code = wait_for(run, child);
        if (!WIFEXITED(code) || WEXITSTATUS(code)) {
            take_mistakes(arguments[0], err, mistakes, room);
            status = shape_error_set(error, SHAPE_ERROR_FORMAT, "%.400s", mistakes);
        } else {
            status = read_all(out, bytes, size, error);
        }
    }
    if (status && !mistakes[0])
        snprintf(mistakes, room, "%s", error->text);
    if (out)
        fclose(out);
    if (err)
        fclose(err);
    return status;
}
