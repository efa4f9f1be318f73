// Private: libraries that ask for memory where nothing may be thrown (moves, destructors), which C++ answers by ending the program by
// abort(). While one of these lives, that end is a line and exit code 1; any other end is as it was. One at a time.
#pragma once

#include <errno.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <system_error>

class OrderlyEnd
{
    static inline std::terminate_handler before = nullptr;
    static inline const char *what = "";

    [[noreturn]] static void end()
    {
        try {
            if (std::current_exception())
                throw;
        } catch (const std::bad_alloc &) {
            say();
        } catch (const std::system_error &) { // a thread or a lock that there was no memory for
            say();
        } catch (...) {
        }
        before();
        std::abort();
    }

    [[noreturn]] static void say()
    {
        std::fprintf(stderr, "%s: not enough memory %s\n", program_invocation_short_name, what);
        std::_Exit(1);
    }

  public:
    // wherefore: "to ..."
    explicit OrderlyEnd(const char *wherefore)
    {
        what = wherefore;
        before = std::set_terminate(end);
    }
    ~OrderlyEnd() { std::set_terminate(before); }
    OrderlyEnd(const OrderlyEnd &) = delete;
    OrderlyEnd &operator=(const OrderlyEnd &) = delete;
};
