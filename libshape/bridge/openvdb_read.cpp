// OpenVDB files from strangers: the header is checked here, the rest is read in a process of its own with limited memory
// and time, which hands its bricks over through a pipe. OpenVDB trusts what a file says of itself; whatever that leads to ends with
// that process.
#include "shape/vdb_read.h"

#include <openvdb/version.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include "bridge/openvdb_grid.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VDB_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define VDB_SANITIZED 1
#endif
#endif

#ifdef NEPHELE_COVERAGE
extern "C" void __gcov_dump(void); // gcc: writes the counts, as an end of a program does
#endif

namespace
{

// What goes through the pipe before the table, the values and their ranges.
struct Message {
    shape_error error;
    shape_vdb_contents contents; // .grid is not used
    shape_grid grid;             // neither are its pointers
    shape_grid colour[3];        // of a coloured grid, as far as there are bricks
};

// --- the other process ---

// Address space beyond what the process has already. The sanitizers need terabytes of it.
void limit_memory(size_t bytes)
{
#if !defined(VDB_SANITIZED)
    char text[64] = "";
    FILE *statm = std::fopen("/proc/self/statm", "r");
    if (!statm)
        return;
    bool read = std::fgets(text, sizeof text, statm);
    std::fclose(statm);
    rlim_t pages = std::strtoull(text, nullptr, 10); // the first number
    const rlim_t spare = rlim_t(64) << 20;
    struct rlimit limit;
    if (!read || getrlimit(RLIMIT_AS, &limit))
        return;
    rlim_t wanted = pages * rlim_t(sysconf(_SC_PAGESIZE)) + bytes + spare;
    if (wanted < limit.rlim_cur)
        limit.rlim_cur = wanted;
    setrlimit(RLIMIT_AS, &limit);
#else
    (void)bytes;
#endif
}

// Seconds of processor time: some, one a MiB of the file, and one for every 64 MiB that the voxels may take.
rlim_t allowed_seconds(size_t file_bytes, size_t max_bytes)
{
    return 10 + rlim_t(file_bytes >> 20) + rlim_t(max_bytes >> 26);
}

void limit_time(rlim_t seconds)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_CPU, &limit))
        return;
    if (seconds < limit.rlim_cur)
        limit.rlim_cur = seconds;
    setrlimit(RLIMIT_CPU, &limit);
    signal(SIGXCPU, SIG_DFL);
}

bool send(int to, const void *bytes, size_t size)
{
    const char *at = static_cast<const char *>(bytes);
    while (size) {
        ssize_t sent = write(to, at, size < (size_t(1) << 30) ? size : size_t(1) << 30);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return false;
        at += sent;
        size -= size_t(sent);
    }
    return true;
}

size_t cells_of(const shape_grid &grid)
{
    return size_t(grid.bricks[0]) * size_t(grid.bricks[1]) * size_t(grid.bricks[2]);
}

void load(const char *path, const shape_vdb_read_options &options, Message &message)
{
    shape_error *error = &message.error;
    try {
        tbb::global_control alone(tbb::global_control::max_allowed_parallelism,
                                  1); // threads do not survive a fork
        vdb_load(path, options, message.contents, error);
    } catch (const std::bad_alloc &) {
        shape_error_set(error, SHAPE_ERROR_LIMIT,
                        "reading it takes more than %zu bytes (damaged, or use --max-memory)",
                        options.max_bytes);
    } catch (const std::exception &problem) {
        shape_error_set(error, SHAPE_ERROR_FORMAT, "OpenVDB cannot read it: %.300s", problem.what());
    } catch (...) {
        shape_error_set(error, SHAPE_ERROR_FORMAT, "OpenVDB cannot read it");
    }
    for (char *c = error->text; error->status && *c; c++) // names in a damaged file may hold anything
        *c = static_cast<unsigned char>(*c) < 0x20 || *c == 0x7f ? '?' : *c;
}

bool send_grid(int to, const shape_grid &grid)
{
    return send(to, grid.table, cells_of(grid) * sizeof *grid.table) &&
           send(to, grid.values, grid.brick_count * SHAPE_GRID_BRICK_POINTS * sizeof *grid.values) &&
           send(to, grid.low, grid.brick_count * sizeof *grid.low) &&
           send(to, grid.high, grid.brick_count * sizeof *grid.high) &&
           send(to, grid.filled, grid.brick_count * sizeof *grid.filled);
}

// No destructors and nothing at exit: those are the other process's. Only what tests/coverage.sh counts is kept.
[[noreturn]] void end_reader(bool sent)
{
#ifdef NEPHELE_COVERAGE
    __gcov_dump();
#endif
    _exit(sent ? 0 : 1);
}

[[noreturn]] void be_the_reader(const char *path, size_t file_bytes, const shape_vdb_read_options &options,
                                int to)
{
    int quiet = open("/dev/null", O_WRONLY);
    if (quiet >= 0)
        dup2(quiet, STDERR_FILENO); // OpenVDB's own warnings, and the runtime's last words
    struct rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
    limit_memory(options.max_bytes);
    limit_time(allowed_seconds(file_bytes, options.max_bytes));
    static Message message; // zero
    load(path, options, message);
    if (message.error.status)
        end_reader(send(to, &message, sizeof message));
    const shape_grid &grid = *message.contents.grid;
    message.grid = grid;
    for (int c = 0; c < 3; c++)
        if (grid.colour[c])
            message.colour[c] = *grid.colour[c];
    bool sent = send(to, &message, sizeof message) && send_grid(to, grid);
    for (int c = 0; c < 3; c++)
        sent = sent && (!grid.colour[c] || send_grid(to, *grid.colour[c]));
    end_reader(sent);
}

// --- this process ---

bool receive(int from, void *bytes, size_t size)
{
    char *at = static_cast<char *>(bytes);
    while (size) {
        ssize_t got = read(from, at, size < (size_t(1) << 30) ? size : size_t(1) << 30);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        size -= size_t(got);
    }
    return true;
}

bool frame_is_sane(const shape_frame &frame)
{
    for (int i = 0; i < 12; i++)
        if (!std::isfinite(frame.m[i / 4][i % 4]))
            return false;
    shape_frame inverse;
    return shape_frame_invert(&frame, &inverse);
}

// A bool that came through the pipe, and may hold what no bool does.
bool is_true(const bool &sent)
{
    unsigned char byte;
    std::memcpy(&byte, &sent, 1);
    return byte == 1;
}

// Even the reader is not trusted further than necessary: its memory may be damaged.
bool is_sane(const shape_grid &g, size_t max_bytes)
{
    for (int a = 0; a < 3; a++)
        if (g.points[a] < 2 || g.points[a] > SHAPE_GRID_MAX_SIDE ||
            g.bricks[a] != (g.points[a] - 1 + SHAPE_GRID_BRICK - 1) / SHAPE_GRID_BRICK)
            return false;
    if (!(g.most > 0) || !std::isfinite(g.most))
        return false;
    return cells_of(g) <= max_bytes / sizeof *g.table && g.brick_count >= 1 &&
           g.brick_count <= max_bytes / (SHAPE_GRID_BRICK_POINTS * sizeof *g.values) + 1;
}

bool values_are_sane(const shape_grid &grid)
{
    for (size_t i = 0; i < grid.brick_count; i++) {
        const float *values = grid.values + i * SHAPE_GRID_BRICK_POINTS, low = grid.low[i],
                    high = grid.high[i];
        if (!(low >= 0 && low <= high && high <= grid.most))
            return false;
        for (int k = 0; k < SHAPE_GRID_BRICK_POINTS; k++)
            if (!(values[k] >= low && values[k] <= high))
                return false;
    }
    return true;
}

// A channel of the colour has the points of its density.
bool is_channel(const Message &m, int c, size_t max_bytes)
{
    return is_sane(m.colour[c], max_bytes) && !is_true(m.colour[c].coloured) &&
           !std::memcmp(m.colour[c].points, m.grid.points, sizeof m.grid.points);
}

// What came ahead of it goes into a grid of our own; false where it is cut short, or memory is out.
bool receive_grid(int from, const shape_grid &head, shape_grid *&made)
{
    shape_grid *grid = made = static_cast<shape_grid *>(std::calloc(1, sizeof *grid));
    if (!grid)
        return false;
    *grid = head;
    grid->table = nullptr;
    grid->values = grid->low = grid->high = nullptr;
    grid->filled = nullptr;
    for (int c = 0; c < 3; c++)
        grid->colour[c] = nullptr;
    grid->coloured = is_true(head.coloured);
    grid->gain = 1;
    grid->users = 1;
    size_t cells = cells_of(*grid), bricks = grid->brick_count;
    grid->table = static_cast<uint32_t *>(std::malloc(cells * sizeof *grid->table));
    grid->values = static_cast<float *>(std::malloc(bricks * SHAPE_GRID_BRICK_POINTS * sizeof *grid->values));
    grid->low = static_cast<float *>(std::malloc(bricks * sizeof *grid->low));
    grid->high = static_cast<float *>(std::malloc(bricks * sizeof *grid->high));
    grid->filled = static_cast<uint64_t *>(std::malloc(bricks * sizeof *grid->filled));
    if (!grid->table || !grid->values || !grid->low || !grid->high || !grid->filled)
        return false;
    if (!receive(from, grid->table, cells * sizeof *grid->table) ||
        !receive(from, grid->values, bricks * SHAPE_GRID_BRICK_POINTS * sizeof *grid->values) ||
        !receive(from, grid->low, bricks * sizeof *grid->low) ||
        !receive(from, grid->high, bricks * sizeof *grid->high) ||
        !receive(from, grid->filled, bricks * sizeof *grid->filled))
        return false;
    for (size_t i = 0; i < cells; i++)
        if (grid->table[i] >= bricks)
            return false;
    return values_are_sane(*grid);
}

shape_status damaged(const char *path, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_FORMAT,
                           "%s: OpenVDB cannot read it (the file is damaged or cut short)", path);
}

shape_status collect(const char *path, int from, size_t max_bytes, shape_vdb_contents *contents,
                     shape_error *error)
{
    static thread_local Message message;
    std::memset(&message, 0, sizeof message);
    if (!receive(from, &message, sizeof message))
        return damaged(path, error);
    message.error.text[sizeof message.error.text - 1] = 0;
    if (message.error.status)
        return shape_error_set(error, message.error.status, "%s: %s", path, message.error.text);
    shape_grid *grid = nullptr;
    bool good = frame_is_sane(message.contents.frame) && is_sane(message.grid, max_bytes) &&
                receive_grid(from, message.grid, grid);
    for (int c = 0; c < 3 && good && grid->coloured; c++)
        good = !message.grid.colour[c] ||
               (is_channel(message, c, max_bytes) && receive_grid(from, message.colour[c], grid->colour[c]));
    if (!good) {
        shape_grid_release(grid);
        return damaged(path, error);
    }
    std::memcpy(contents->name, message.contents.name, SHAPE_NAME_MAX);
    contents->name[SHAPE_NAME_MAX] = 0;
    contents->frame = message.contents.frame;
    contents->level_set = is_true(message.contents.level_set);
    contents->grid = grid;
    return SHAPE_OK;
}

shape_status read_apart(const char *path, size_t file_bytes, const char *shown,
                        const shape_vdb_read_options *options, shape_vdb_contents *contents,
                        shape_error *error)
{
    int ends[2];
    if (pipe(ends))
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "%s: no pipe to read it through: %s", shown,
                               std::strerror(errno));
    std::fflush(nullptr);
    pid_t reader = fork();
    if (reader < 0) {
        close(ends[0]);
        close(ends[1]);
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "%s: no process to read it in: %s", shown,
                               std::strerror(errno));
    }
    if (!reader) {
        close(ends[0]);
        be_the_reader(path, file_bytes, *options, ends[1]);
    }
    close(ends[1]);
    shape_status status = collect(shown, ends[0], options->max_bytes, contents, error);
    close(ends[0]); // a reader that still writes ends by it
    int how = 0;
    while (waitpid(reader, &how, 0) < 0 && errno == EINTR) {
    }
    if (status && WIFSIGNALED(how) && WTERMSIG(how) == SIGXCPU)
        return shape_error_set(
            error, SHAPE_ERROR_LIMIT,
            "%s: reading it takes more than %llu s of processor time (damaged, or use "
            "--max-memory, which allows more)",
            shown, static_cast<unsigned long long>(allowed_seconds(file_bytes, options->max_bytes)));
    return status;
}

uint32_t get_u32(const unsigned char *p)
{
    return uint32_t(p[0]) | uint32_t(p[1]) << 8 | uint32_t(p[2]) << 16 | uint32_t(p[3]) << 24;
}

// The first bytes: 64 bits of magic, then the format's version. A wrong version would open, and hold no grid.
shape_status check_header(const char *path, const unsigned char *bytes, size_t size, shape_error *error)
{
    if (!shape_vdb_is(bytes, size))
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: no OpenVDB file", path);
    if (size < 12)
        return shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: an OpenVDB file cut short", path);
    uint32_t version = get_u32(bytes + 8);
    if (version < openvdb::OPENVDB_FILE_VERSION_ROOTNODE_MAP || version > openvdb::OPENVDB_FILE_VERSION)
        return shape_error_set(
            error, SHAPE_ERROR_FORMAT,
            "%s: an OpenVDB file of version %u; %u to %u can be read (write it again with another)", path,
            version, unsigned(openvdb::OPENVDB_FILE_VERSION_ROOTNODE_MAP),
            unsigned(openvdb::OPENVDB_FILE_VERSION));
    return SHAPE_OK;
}

} // namespace

extern "C" shape_status shape_vdb_read(const char *path, const shape_vdb_read_options *options,
                                       shape_vdb_contents *contents, shape_error *error)
{
    unsigned char first[12];
    const char *shown = options->shown ? options->shown : path;
    std::memset(contents, 0, sizeof *contents);
    FILE *file = std::fopen(path, "rb");
    if (!file)
        return shape_error_set(error, SHAPE_ERROR_IO, "%s: cannot read: %s", shown, std::strerror(errno));
    size_t size = std::fread(first, 1, sizeof first, file);
    bool wrong = std::ferror(file) || std::fseek(file, 0, SEEK_END);
    long end = wrong ? -1 : std::ftell(file);
    std::fclose(file);
    if (end < 0)
        return shape_error_set(error, SHAPE_ERROR_IO, "%s: cannot read it", shown);
    shape_status status = check_header(shown, first, size, error);
    if (!status)
        status = read_apart(path, size_t(end), shown, options, contents, error);
    contents->file_bytes = size_t(end);
    return status;
}
