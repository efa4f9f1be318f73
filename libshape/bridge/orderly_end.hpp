// Private: libraries that ask for memory where nothing may be thrown (moves, destructors), which C++ answers by ending the program by
// abort(). While one of these lives, that end is a line and exit code 1; any other end is as it was. One at a time.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

class OrderlyEnd
{
    static inline std::terminate_handler before = nullptr;
    static inline const char *line = "";

    [[noreturn]] static void end()
    {
        try {
            if (std::current_exception())
                throw;
        } catch (const std::bad_alloc &) {
            std::fputs(line, stderr);
            std::_Exit(1);
        } catch (...) {
        }
        before();
        std::abort();
    }

  public:
    explicit OrderlyEnd(const char *text)
    {
        line = text;
        before = std::set_terminate(end);
    }
    ~OrderlyEnd() { std::set_terminate(before); }
    OrderlyEnd(const OrderlyEnd &) = delete;
    OrderlyEnd &operator=(const OrderlyEnd &) = delete;
};
