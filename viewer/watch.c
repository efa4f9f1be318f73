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

#include "cli_scene.h"
#include "run.h"
#include "shape/file.h"

enum { LOOK_MS = 20, REST_MS = 60, SILENT_MS = 1000 };

/* What tells one version of a file from another. */
typedef struct file_mark {
    dev_t device;
    ino_t number;
    off_t size;
    struct timespec changed, saved; /* saved: also when another took its place */
} file_mark;

/* One file, and what is known of it. */
typedef struct watched_file {
    char *path;
    const char *name;      /* within path */
    int folder;            /* its folder's number of inotify, or -1 */
    file_mark shown, seen; /* as it was read; as it was last seen */
    bool there, writing, closed;
    double changed; /* when `seen` last changed */
} watched_file;

struct view_watch {
    char path[VIEW_PATH_MAX];
    const view_more_things *more;
    void (*wake)(void);
    view_run *run; /* of a program that makes the clouds */
    pthread_t thread;
    pthread_mutex_t mutex;
    int pipe[2]; /* a byte in it wakes the thread */
    int notify;  /* -1: none */
    /* The thread's own. */
    watched_file files[VIEW_FILES_MAX]; /* the opened one first */
    int file_count;
    /* Under the mutex. */
    view_generator generator;
    bool asked, stop, fresh, busy;
    bool dropped, left; /* dropped: nobody waits for what is being read; left: the thread frees all */
    double busy_since;
    view_news news;
};

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

double view_work_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
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
    mark->saved = status.st_ctim;
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
        view_contents_free(&watch->news.contents);
    watch->news = *news;
    watch->fresh = true;
    watch->busy = false;
    pthread_mutex_unlock(&watch->mutex);
    watch->wake();
}

/* --- which files --- */

bool view_watch_can(const char *path)
{
    struct stat status;
    return path[0] && strcmp(path, "-") && (stat(path, &status) || S_ISREG(status.st_mode));
}

static bool is_file(const view_watch *watch)
{
    return view_watch_can(watch->path);
}

/* The number of a file's folder; -1 where nothing tells of it. */
static int watch_folder(const view_watch *watch, const char *path, const char *name)
{
    char folder[VIEW_PATH_MAX] = ".";
    size_t length = (size_t)(name - path);
    if (watch->notify < 0)
        return -1;
    if (length)
        snprintf(folder, sizeof folder, "%.*s", (int)(length > 1 ? length - 1 : 1), path);
    return inotify_add_watch(watch->notify, folder, IN_MODIFY | IN_CLOSE_WRITE | IN_MOVED_TO);
}

static void add_file(view_watch *watch, const char *path)
{
    for (int i = 0; i < watch->file_count; i++)
        if (!strcmp(watch->files[i].path, path))
            return;
    if (watch->file_count == VIEW_FILES_MAX)
        return;
    watched_file *file = &watch->files[watch->file_count];
    memset(file, 0, sizeof *file);
    file->path = strdup(path);
    if (!file->path)
        return; /* it is only not watched */
    const char *slash = strrchr(file->path, '/');
    file->name = slash ? slash + 1 : file->path;
    file->folder = watch_folder(watch, file->path, file->name);
    file->there = look(file->path, &file->shown);
    file->seen = file->shown;
    watch->file_count++;
}

static void add_scene_file(view_watch *watch, const char *name)
{
    shape_error error;
    char *path;
    if (!name || shape_scene_find_file(watch->path, name, cli_outside_allowed(), &path, &error))
        return; /* reading the scene says what is wrong with it */
    add_file(watch, path);
    free(path);
}

/* Files that are not named any more stay watched: reading once too often does no harm. */
static void add_named(view_watch *watch, const shape_scene *scene)
{
    for (size_t i = 0; scene && i < scene->cloud_count; i++) {
        add_scene_file(watch, scene->clouds[i].file);
        add_scene_file(watch, scene->clouds[i].input);
    }
    for (size_t i = 0; scene && i < scene->mesh_count; i++)
        add_scene_file(watch, scene->meshes[i].file);
}

/* Of a scene as it was opened. */
static void add_opened_scene(view_watch *watch)
{
    unsigned char *bytes;
    size_t size;
    shape_scene *scene = NULL;
    shape_error error;
    if (shape_file_read(watch->path, 0x40000000, &bytes, &size, &error))
        return;
    if (shape_scene_is(bytes, size) && !shape_scene_decode(bytes, size, watch->path, &scene, &error))
        add_named(watch, scene);
    shape_scene_destroy(scene);
    free(bytes);
}

/* --- reading --- */

/* things: whether what is opaque is to be read, too. */
static void read_file(view_watch *watch, double since, bool things)
{
    view_news news;
    shape_error error;
    double start = now_ms(), work = view_work_ms();
    memset(&news, 0, sizeof news);
    pthread_mutex_lock(&watch->mutex);
    view_generator generator = watch->generator;
    if (!watch->busy)
        watch->busy_since = now_ms();
    watch->busy = true;
    watch->dropped = false;
    if (!watch->stop)
        view_run_begin(watch->run); /* not after a stop, which cancelled for good */
    pthread_mutex_unlock(&watch->mutex);
    view_source_read(watch->path, &generator, watch->run, watch->more, things && watch->more, &news.contents,
                     news.text, sizeof news.text, &error);
    add_named(watch, news.contents.scene);
    pthread_mutex_lock(&watch->mutex);
    bool outdated = watch->asked || watch->stop || watch->dropped; /* and perhaps broken off */
    if (watch->dropped && !watch->asked)
        watch->busy = false;
    pthread_mutex_unlock(&watch->mutex);
    if (outdated) {
        view_contents_free(&news.contents);
        return;
    }
    news.saved = since;
    news.work = work;
    news.milliseconds = now_ms() - start;
    publish(watch, &news);
}

static void tell_gone(view_watch *watch, const char *path)
{
    view_news news;
    memset(&news, 0, sizeof news);
    snprintf(news.text, sizeof news.text, "%.4000s: the file is gone (what it held is still shown)", path);
    publish(watch, &news);
}

/* Notes an event: somebody has changed a file and not closed it, or it is whole again. */
static void note_event(view_watch *watch, const struct inotify_event *event, const char *name)
{
    for (int i = 0; i < watch->file_count; i++) {
        watched_file *file = &watch->files[i];
        if (file->folder != event->wd || strcmp(name, file->name))
            continue;
        if (event->mask & IN_MODIFY)
            file->writing = true;
        if (event->mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) {
            file->writing = false;
            file->closed = true;
        }
    }
}

static void read_events(view_watch *watch)
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
            if (event.len)
                note_event(watch, &event, name);
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

/* Whether the file is to be read now: it has been closed, or it has changed and then rested for a while without a word.
 * Never while somebody writes it. */
static bool is_ready(watched_file *file, const file_mark *mark)
{
    double time = now_ms();
    if (!same(mark, &file->seen)) {
        file->seen = *mark;
        file->changed = time;
    }
    if (file->writing)
        return false;
    return file->closed ||
           (!same(mark, &file->shown) && time - file->changed > (file->folder < 0 ? REST_MS : SILENT_MS));
}

/* One look at a file; whether it is to be read. */
static bool attend_file(view_watch *watch, watched_file *file, bool asked)
{
    file_mark mark;
    bool there = look(file->path, &mark);
    if (!there && (file->there || asked))
        tell_gone(watch, file->path);
    if (there && !file->there)
        memset(&file->shown, 0, sizeof file->shown); /* it is back, with whatever it holds */
    file->there = there;
    bool ready = there && (is_ready(file, &mark) || asked);
    file->closed = false;
    if (ready)
        file->shown = mark;
    return ready;
}

/* When a file was changed last, written or put in its place, on the clock of now_ms(); now where that cannot be. */
static double saved_at(const file_mark *mark)
{
    enum { MOST_MS = 10000 };
    struct timespec time;
    clock_gettime(CLOCK_REALTIME, &time);
    double ago =
        1e3 * difftime(time.tv_sec, mark->saved.tv_sec) + 1e-6 * (double)(time.tv_nsec - mark->saved.tv_nsec);
    return now_ms() - (ago > 0 && ago < MOST_MS ? ago : 0);
}

/* One look at all files. */
static void attend(view_watch *watch, bool asked)
{
    bool ready = false, things = false;
    double saved = now_ms();
    if (watch->notify >= 0)
        read_events(watch);
    for (int i = 0; i < watch->file_count; i++)
        if (attend_file(watch, &watch->files[i], asked && i == 0 && is_file(watch))) {
            ready = true;
            things = things || i > 0;
            if (!asked)
                saved = saved_at(&watch->files[i].shown);
        }
    if (ready || (asked && !is_file(watch)))
        read_file(watch, saved, things);
}

static void free_watch(view_watch *watch);

/* Whether it is to end; where nobody waits for that, all is freed. */
static bool ends(view_watch *watch, bool *asked)
{
    pthread_mutex_lock(&watch->mutex);
    bool stop = watch->stop, left = watch->left;
    *asked = watch->asked;
    watch->asked = false;
    pthread_mutex_unlock(&watch->mutex);
    if (stop && left)
        free_watch(watch);
    return stop;
}

static void *watch_thread(void *context)
{
    view_watch *watch = context;
    bool asked;
    if (is_file(watch))
        add_file(watch, watch->path);
    if (is_file(watch))
        add_opened_scene(watch);
    for (size_t i = 0; watch->more && watch->more->list && i < watch->more->list->mesh_count; i++)
        add_file(watch, watch->more->list->meshes[i].file);
    for (;;) {
        wait_for(watch, !watch->file_count ? -1 : watch->notify >= 0 ? 250 : LOOK_MS);
        if (ends(watch, &asked))
            return NULL;
        attend(watch, asked);
    }
}

static void free_watch(view_watch *watch)
{
    for (int i = 0; i < watch->file_count; i++)
        free(watch->files[i].path);
    if (watch->fresh)
        view_contents_free(&watch->news.contents);
    if (watch->notify >= 0)
        close(watch->notify);
    close(watch->pipe[0]);
    close(watch->pipe[1]);
    pthread_mutex_destroy(&watch->mutex);
    view_run_destroy(watch->run);
    free(watch);
}

view_watch *view_watch_start(const char *path, const view_generator *generator, const view_more_things *more,
                             void (*wake)(void), shape_error *error)
{
    view_watch *watch = calloc(1, sizeof *watch);
    if (!watch) {
        shape_error_memory(error);
        return NULL;
    }
    snprintf(watch->path, sizeof watch->path, "%s", path);
    watch->generator = *generator;
    watch->more = more;
    watch->wake = wake;
    watch->run = view_run_create();
    if (!watch->run || pipe(watch->pipe)) {
        shape_error_set(error, SHAPE_ERROR_SYSTEM, "no pipe: %s", strerror(errno));
        view_run_destroy(watch->run);
        free(watch);
        return NULL;
    }
    watch->notify = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    pthread_mutex_init(&watch->mutex, NULL);
    int failed = pthread_create(&watch->thread, NULL, watch_thread, watch);
    if (!failed)
        return watch;
    shape_error_set(error, SHAPE_ERROR_SYSTEM, "no thread: %s", strerror(failed));
    free_watch(watch);
    return NULL;
}

static void wake_thread(const view_watch *watch)
{
    ssize_t written = write(watch->pipe[1], "", 1);
    (void)written; /* a full pipe wakes as well */
}

/* The thread may free it as soon as the mutex is let go, so all is done before. */
static void ask_to_end(view_watch *watch, bool leave)
{
    pthread_mutex_lock(&watch->mutex);
    watch->stop = true;
    watch->left = leave;
    view_run_cancel(watch->run);
    wake_thread(watch);
    if (leave)
        pthread_detach(watch->thread);
    pthread_mutex_unlock(&watch->mutex);
}

void view_watch_leave(view_watch *watch)
{
    if (watch)
        ask_to_end(watch, true);
}

void view_watch_cancel(view_watch *watch)
{
    pthread_mutex_lock(&watch->mutex);
    if (watch->busy) {
        watch->dropped = true;
        view_run_cancel(watch->run);
    }
    pthread_mutex_unlock(&watch->mutex);
}

void view_watch_stop(view_watch *watch)
{
    if (!watch)
        return;
    ask_to_end(watch, false);
    pthread_join(watch->thread, NULL);
    free_watch(watch);
}

void view_watch_ask(view_watch *watch, const view_generator *generator)
{
    pthread_mutex_lock(&watch->mutex);
    watch->generator = *generator;
    if (!watch->busy)
        watch->busy_since = now_ms();
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

double view_watch_busy_for(view_watch *watch)
{
    pthread_mutex_lock(&watch->mutex);
    double since = watch->busy ? now_ms() - watch->busy_since : 0;
    pthread_mutex_unlock(&watch->mutex);
    return since;
}
