/* Drops a file on a window as a file manager does: the XDND protocol, version 5 (freedesktop.org, 2002), from a window of its
 * own. For tests of neph-view's window; built by them with -lX11.
 *
 *     drop_file WINDOW PATH        exits 0 when the other side says that it has taken the file */
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { VERSION = 5, WAIT_SECONDS = 60 };

static Display *display;
static Window own, target;
static char uri[4200];

static Atom atom(const char *name)
{
    return XInternAtom(display, name, False);
}

static void tell(const char *message, long a, long b, long c, long d)
{
    XEvent event = {.xclient = {.type = ClientMessage, .window = target, .format = 32}};
    event.xclient.message_type = atom(message);
    const long data[5] = {(long)own, a, b, c, d};
    memcpy(event.xclient.data.l, data, sizeof data);
    XSendEvent(display, target, False, NoEventMask, &event);
    XFlush(display);
}

/* The other side asks for what is dropped. */
static void answer(const XSelectionRequestEvent *request)
{
    XEvent event = {.xselection = {.type = SelectionNotify,
                                   .requestor = request->requestor,
                                   .selection = request->selection,
                                   .target = request->target,
                                   .property = request->property,
                                   .time = request->time}};
    XChangeProperty(display, request->requestor, request->property, request->target, 8, PropModeReplace,
                    (unsigned char *)uri, (int)strlen(uri));
    XSendEvent(display, request->requestor, False, NoEventMask, &event);
    XFlush(display);
}

/* Until the other side has finished; its status, which says that it would take the file, is answered by the drop. */
static int serve(void)
{
    XEvent event;
    for (;;) {
        XNextEvent(display, &event);
        if (event.type == SelectionRequest)
            answer(&event.xselectionrequest);
        else if (event.type == ClientMessage && event.xclient.message_type == atom("XdndStatus"))
            tell("XdndDrop", 0, CurrentTime, 0, 0);
        else if (event.type == ClientMessage && event.xclient.message_type == atom("XdndFinished"))
            return event.xclient.data.l[1] ? 0 : 1; /* a flag, but GLFW 3.3 sends how many bytes it took */
    }
}

int main(int argc, char **argv)
{
    char path[4096];
    if (argc != 3 || !realpath(argv[2], path) || !(display = XOpenDisplay(NULL))) {
        fprintf(stderr, "drop_file WINDOW PATH, with a display\n");
        return 2;
    }
    snprintf(uri, sizeof uri, "file://%s\r\n", path);
    target = (Window)strtoul(argv[1], NULL, 0);
    own = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display, atom("XdndSelection"), own, CurrentTime);
    alarm(WAIT_SECONDS);
    tell("XdndEnter", (long)VERSION << 24, (long)atom("text/uri-list"), 0, 0);
    tell("XdndPosition", 0, 100 << 16 | 100, CurrentTime, (long)atom("XdndActionCopy"));
    return serve();
}
