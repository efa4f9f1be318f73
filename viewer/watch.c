/* Live reload: inotify tells when a writer has closed the file or has put another in its place, so a half-written one is
 * never read; where a folder cannot be watched, or tells nothing (some network file systems), its time and size are
 * looked at, and taken once they have rested. */
#include "watch.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "run.h"

enum { LOOK_MS = 20, REST_MS = 60, SILENT_MS = 1000 };

/* What tells one version of a file from another. */
typedef struct file_mark {
    dev_t device;
    ino_t number;
    off_t size;
    struct timespec changed;
} file_mark;

struct view_watch {
    char path[VIEW_PATH_MAX], folder[VIEW_PATH_MAX];
    const char *name; /* within path */
    void (*wake)(void);
    view_run *run; /* of a generator's program */
    pthread_t thread;
    pthread_mutex_t mutex;
    int pipe[2]; /* a byte in it wakes the thread */
    int notify;  /* -1: none */
    /* Under the mutex. */
    view_generator generator;
    bool asked, stop, fresh, busy;
    view_news news;
};

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static bool look(const char *path, file_mark *mark)
{
    struct stat status;
    memset(mark, 0, sizeof *mark);
    if (stat(path, &status))
        return false;
    mark->device = status.st_dev;
    mark->number = status.st_ino;
    mark->size = status.st_size;
    mark->changed = status.st_mtim;
    return true;
}

static bool same(const file_mark *a, const file_mark *b)
{
    return a->device == b->device && a->number == b->number && a->size == b->size &&
           a->changed.tv_sec == b->changed.tv_sec && a->changed.tv_nsec == b->changed.tv_nsec;
}

static void publish(view_watch *watch, view_news *news)
{
    pthread_mutex_lock(&watch->mutex);
    if (watch->fresh) /* news that nobody has taken */
        shape_set_destroy(watch->news.contents.set);
    watch->news = *news;
    watch->fresh = true;
    watch->busy = false;
    pthread_mutex_unlock(&watch->mutex);
    watch->wake();
}

static void read_file(view_watch *watch, double since)
{
    view_news news;
    shape_error error;
    memset(&news, 0, sizeof news);
    pthread_mutex_lock(&watch->mutex);
    view_generator generator = watch->generator;
    watch->busy = true;
    pthread_mutex_unlock(&watch->mutex);
    view_source_read(watch->path, &generator, watch->run, &news.contents, news.text, sizeof news.text,
                     &error);
    pthread_mutex_lock(&watch->mutex);
    bool outdated = watch->asked || watch->stop; /* and perhaps broken off */
    pthread_mutex_unlock(&watch->mutex);
    if (outdated) {
        shape_set_destroy(news.contents.set);
        return;
    }
    news.saved = since;
    news.milliseconds = now_ms() - since;
    publish(watch, &news);
}

static void tell_gone(view_watch *watch)
{
    view_news news;
    memset(&news, 0, sizeof news);
    snprintf(news.text, sizeof news.text, "%.4000s: the file is gone (what it held is still shown)",
             watch->path);
    publish(watch, &news);
}

/* Reads all events. *writing: somebody has changed the file and not closed it; *closed: it is whole again. */
static void read_events(const view_watch *watch, bool *writing, bool *closed)
{
    union {
        struct inotify_event event;
        char bytes[16384];
    } buffer;
    for (;;) {
        ssize_t size = read(watch->notify, buffer.bytes, sizeof buffer.bytes);
        if (size <= 0)
            return;
        for (char *at = buffer.bytes; at < buffer.bytes + size;) {
            struct inotify_event event;
            memcpy(&event, at, sizeof event);
            const char *name = at + sizeof event;
            at += sizeof event + event.len;
            if (!event.len || strcmp(name, watch->name))
                continue;
            if (event.mask & IN_MODIFY)
                *writing = true;
            if (event.mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) {
                *writing = false;
                *closed = true;
            }
        }
    }
}

/* Waits for an event, a byte in the pipe, or some time. */
static void wait_for(const view_watch *watch, int milliseconds)
{
    struct pollfd files[2] = {{watch->pipe[0], POLLIN, 0}, {watch->notify, POLLIN, 0}};
    char bytes[64];
    poll(files, watch->notify >= 0 ? 2 : 1, milliseconds);
    if (files[0].revents & POLLIN && read(watch->pipe[0], bytes, sizeof bytes) < 0)
        return; /* empty again: a byte is a wish to wake and nothing else */
}

/* What the watching thread knows of the file. */
typedef struct watch_state {
    file_mark shown, seen; /* as it was read; as it was last seen */
    bool there, writing;
    double changed; /* when `seen` last changed */
} watch_state;

/* Whether the file is to be read now: it has been closed, or it has changed and then rested for a while without a word.
 * Never while somebody writes it. */
static bool is_ready(const view_watch *watch, watch_state *state, const file_mark *mark, bool closed)
{
    double time = now_ms();
    if (!same(mark, &state->seen)) {
        state->seen = *mark;
        state->changed = time;
    }
    if (state->writing)
        return false;
    return closed ||
           (!same(mark, &state->shown) && time - state->changed > (watch->notify < 0 ? REST_MS : SILENT_MS));
}

/* One look at the file. */
static void attend(view_watch *watch, watch_state *state, bool asked)
{
    bool closed = false;
    file_mark mark;
    if (watch->notify >= 0)
        read_events(watch, &state->writing, &closed);
    bool there = look(watch->path, &mark);
    if (!there && (state->there || asked))
        tell_gone(watch);
    if (there && !state->there)
        memset(&state->shown, 0, sizeof state->shown); /* it is back, with whatever it holds */
    state->there = there;
    if (there && (is_ready(watch, state, &mark, closed) || asked)) {
        state->shown = mark;
        read_file(watch, now_ms());
    }
}

static void *watch_thread(void *context)
{
    view_watch *watch = context;
    watch_state state;
    memset(&state, 0, sizeof state);
    bool watched = watch->path[0] && strcmp(watch->path, "-");
    state.there = watched && look(watch->path, &state.shown);
    state.seen = state.shown;
    for (;;) {
        wait_for(watch, watched ? (watch->notify >= 0 ? 250 : LOOK_MS) : -1);
        pthread_mutex_lock(&watch->mutex);
        bool stop = watch->stop, asked = watch->asked;
        watch->asked = false;
        pthread_mutex_unlock(&watch->mutex);
        if (stop)
            return NULL;
        if (watched)
            attend(watch, &state, asked);
        else if (asked && !watch->path[0])
            read_file(watch, now_ms());
    }
}

static void open_notify(view_watch *watch)
{
    watch->notify = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (watch->notify >= 0 &&
        inotify_add_watch(watch->notify, watch->folder, IN_MODIFY | IN_CLOSE_WRITE | IN_MOVED_TO) < 0) {
        close(watch->notify);
        watch->notify = -1;
    }
}

static void split_path(view_watch *watch, const char *path)
{
    snprintf(watch->path, sizeof watch->path, "%s", path);
    const char *slash = strrchr(watch->path, '/');
    watch->name = slash ? slash + 1 : watch->path;
    size_t length = slash ? (size_t)(slash - watch->path) : 0;
    snprintf(watch->folder, sizeof watch->folder, "%.*s", (int)length, watch->path);
    if (!slash)
        snprintf(watch->folder, sizeof watch->folder, ".");
    else if (!length)
        snprintf(watch->folder, sizeof watch->folder, "/");
}

view_watch *view_watch_start(const char *path, const view_generator *generator, void (*wake)(void),
                             shape_error *error)
{
    view_watch *watch = calloc(1, sizeof *watch);
    if (!watch) {
        shape_error_memory(error);
        return NULL;
    }
    split_path(watch, path);
    watch->generator = *generator;
    watch->wake = wake;
    watch->notify = -1;
    watch->run = view_run_create();
    if (!watch->run || pipe(watch->pipe)) {
        shape_error_set(error, SHAPE_ERROR_SYSTEM, "no pipe: %s", strerror(errno));
        view_run_destroy(watch->run);
        free(watch);
        return NULL;
    }
    if (path[0] && strcmp(path, "-"))
        open_notify(watch);
    pthread_mutex_init(&watch->mutex, NULL);
    int failed = pthread_create(&watch->thread, NULL, watch_thread, watch);
    if (!failed)
        return watch;
    shape_error_set(error, SHAPE_ERROR_SYSTEM, "no thread: %s", strerror(failed));
    if (watch->notify >= 0)
        close(watch->notify);
    close(watch->pipe[0]);
    close(watch->pipe[1]);
    pthread_mutex_destroy(&watch->mutex);
    view_run_destroy(watch->run);
    free(watch);
    return NULL;
}

static void wake_thread(const view_watch *watch)
{
    ssize_t written = write(watch->pipe[1], "", 1);
    (void)written; /* a full pipe wakes as well */
}

void view_watch_stop(view_watch *watch)
{
    if (!watch)
        return;
    pthread_mutex_lock(&watch->mutex);
    watch->stop = true;
    pthread_mutex_unlock(&watch->mutex);
    view_run_cancel(watch->run);
    wake_thread(watch);
    pthread_join(watch->thread, NULL);
    if (watch->fresh)
        shape_set_destroy(watch->news.contents.set);
    if (watch->notify >= 0)
        close(watch->notify);
    close(watch->pipe[0]);
    close(watch->pipe[1]);
    pthread_mutex_destroy(&watch->mutex);
    view_run_destroy(watch->run);
    free(watch);
}

void view_watch_ask(view_watch *watch, const view_generator *generator)
{
    pthread_mutex_lock(&watch->mutex);
    watch->generator = *generator;
    watch->asked = watch->busy = true;
    pthread_mutex_unlock(&watch->mutex);
    view_run_cancel(watch->run); /* what is being made is of older settings */
    wake_thread(watch);
}

bool view_watch_take(view_watch *watch, view_news *news)
{
    pthread_mutex_lock(&watch->mutex);
    bool fresh = watch->fresh;
    if (fresh)
        *news = watch->news;
    watch->fresh = false;
    pthread_mutex_unlock(&watch->mutex);
    return fresh;
}

bool view_watch_is_busy(view_watch *watch)
{
    pthread_mutex_lock(&watch->mutex);
    bool busy = watch->busy;
    pthread_mutex_unlock(&watch->mutex);
    return busy;
}
