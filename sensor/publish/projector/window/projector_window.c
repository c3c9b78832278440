/* sensor/publish/projector/window/projector_window.c: pitviper-projector: a window, or a whole display, that shows the
 * newest image in shared memory and says when it was flipped, and that takes a gamepad's sticks. The node starts it
 * (sensor/publish/projector/display_window.c); it is a program of its own since a window system that fails, or is slow,
 * ends or holds up the program that it serves.
 *
 *     pitviper-projector DISPLAY WIDTHxHEIGHT|full one|whole|fit on|off none|level|body ADDRESS:PORT
 *
 * Image size is in the shared memory; ADDRESS:PORT takes the poses of a gamepad, in axes of the word before. */
#include "sensor/publish/projector/window/gamepad.h"
#include "sensor/publish/projector/window_wire.h"

#define SDL_MAIN_HANDLED
#include <SDL.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { look_ms = 20 }; /* the window system's events are taken at this interval */

typedef struct Shown {
    WindowShared *shared;
    int           width, height;
    uint32_t      own; /* the image that is shown */
    bool          any;
    SDL_Window   *window;
    SDL_Renderer *renderer;
    SDL_Texture  *texture;
    SDL_Rect      place;
    Gamepad       gamepad;
} Shown;

static void send_message(const WindowMessage *m)
{
    while (send(window_socket, m, sizeof *m, MSG_NOSIGNAL) < 0 && errno == EINTR) {
    }
}

static void say(WindowEvent event, uint32_t number, const char *text)
{
    WindowMessage m = {.event = event, .number = number};
    snprintf(m.text, sizeof m.text, "%s", text);
    send_message(&m);
}

static void note(const char *text) { say(WINDOW_NOTED, 0, text); }

static int failed(const char *what)
{
    char text[window_text_size];
    snprintf(text, sizeof text, "%s: %s", what, SDL_GetError());
    say(WINDOW_FAILED, 0, text);
    return 1;
}

static bool map(Shown *s)
{
    struct stat about;
    if (fstat(window_memory, &about) != 0 || about.st_size < window_header_octets) return false;
    void *const at = mmap(NULL, (size_t)about.st_size, PROT_READ | PROT_WRITE, MAP_SHARED, window_memory, 0);
    if (at == MAP_FAILED) return false;
    s->shared = at;
    s->width = s->shared->width;
    s->height = s->shared->height;
    return s->width > 0 && s->height > 0 && (off_t)window_octets(s->width, s->height) == about.st_size;
}

/* Where the image is on an area of width x height; false: there is no room for it. */
static bool place(SDL_Rect *out, const Shown *s, int width, int height, const char *scale)
{
    const double room_x = (double)width / s->width, room_y = (double)height / s->height;
    double       times = room_x < room_y ? room_x : room_y;
    if (strcmp(scale, "fit") != 0) {
        if (times < 1) return false;
        times = strcmp(scale, "one") == 0 ? 1 : (double)(int)times;
    }
    out->w = (int)(s->width * times + 0.5);
    out->h = (int)(s->height * times + 0.5);
    if (out->w < 1) out->w = 1;
    if (out->h < 1) out->h = 1;
    out->x = (width - out->w) / 2;
    out->y = (height - out->h) / 2;
    return true;
}

static bool open_window(Shown *s, int display, const char *size, const char *scale, bool vsync)
{
    const bool full = strcmp(size, "full") == 0;
    int        width = 0, height = 0;
    char       text[window_text_size];
    SDL_Rect   bounds;
    if (!full && sscanf(size, "%dx%d", &width, &height) != 2) return SDL_SetError("'%s' is no size", size), false;
    if (display >= SDL_GetNumVideoDisplays())
        return SDL_SetError("there is no display %d, but %d", display, SDL_GetNumVideoDisplays()), false;
    if (SDL_GetDisplayBounds(display, &bounds) != 0) return false;
    if (full) width = bounds.w, height = bounds.h;
    if (!place(&s->place, s, width, height, scale))
        return SDL_SetError("an image of %d x %d has no room on %d x %d: projector.scale: fit shows it smaller",
                            s->width, s->height, width, height),
               false;
    const int centred = (int)SDL_WINDOWPOS_CENTERED_DISPLAY(display);
    s->window = SDL_CreateWindow("Pitviper", centred, centred, width, height,
                                 SDL_WINDOW_BORDERLESS | (full ? SDL_WINDOW_FULLSCREEN_DESKTOP : 0));
    if (!s->window) return false;
    s->renderer = SDL_CreateRenderer(s->window, -1, vsync ? SDL_RENDERER_PRESENTVSYNC : 0);
    if (!s->renderer) return false;
    s->texture =
        SDL_CreateTexture(s->renderer, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STREAMING, s->width, s->height);
    if (!s->texture || SDL_SetTextureBlendMode(s->texture, SDL_BLENDMODE_NONE) != 0 ||
        SDL_SetTextureScaleMode(s->texture, SDL_ScaleModeNearest) != 0 ||
        SDL_GetRendererOutputSize(s->renderer, &width, &height) != 0)
        return false;
    if (!place(&s->place, s, width, height, scale)) return SDL_SetError("the window became too small"), false;
    SDL_DisplayMode  mode = {0};
    SDL_RendererInfo info = {0};
    SDL_GetCurrentDisplayMode(display, &mode);
    SDL_GetRendererInfo(s->renderer, &info);
    snprintf(text, sizeof text,
             "display %d of %s, %d x %d at %d Hz; %s renderer%s; the image is %d x %d at column %d, row %d", display,
             SDL_GetCurrentVideoDriver(), width, height, mode.refresh_rate, info.name ? info.name : "unknown",
             !vsync                                   ? ""
             : info.flags & SDL_RENDERER_PRESENTVSYNC ? ", which says that it keeps step with the refresh"
                                                      : ", which keeps no step with the refresh",
             s->place.w, s->place.h, s->place.x, s->place.y);
    SDL_ShowCursor(SDL_DISABLE);
    say(WINDOW_OPENED, (uint32_t)mode.refresh_rate * 1000, text);
    return true;
}

static bool present(Shown *s)
{
    SDL_SetRenderDrawColor(s->renderer, 0, 0, 0, 255);
    if (SDL_RenderClear(s->renderer) != 0) return false;
    if (s->any && SDL_RenderCopy(s->renderer, s->texture, NULL, &s->place) != 0) return false;
    SDL_RenderPresent(s->renderer);
    return true;
}

/* Shows the newest image, if there is one that was not shown. False: SDL failed. */
static bool show_newest(Shown *s)
{
    struct timespec now;
    if (!window_is_fresh(s->shared)) return true;
    s->own = window_take(s->shared, s->own);
    const uint32_t number = s->shared->number[s->own];
    if (SDL_UpdateTexture(s->texture, NULL, window_image(s->shared, s->width, s->height, s->own), 4 * s->width) != 0)
        return false;
    s->any = true;
    if (!present(s)) return false;
    clock_gettime(CLOCK_MONOTONIC, &now);
    send_message(&(WindowMessage){.event = WINDOW_FLIPPED,
                                  .number = number,
                                  .newer = (uint32_t)window_is_fresh(s->shared),
                                  .time_ns = (int64_t)now.tv_sec * 1000000000 + now.tv_nsec});
    return true;
}

/* False: its user closed it. */
static bool take_events(Shown *s, bool *ok)
{
    SDL_Event e;
    while (SDL_PollEvent(&e)) {
        if (e.type == SDL_QUIT || (e.type == SDL_KEYDOWN && e.key.keysym.sym == SDLK_ESCAPE)) return false;
        if (e.type == SDL_WINDOWEVENT && e.window.event == SDL_WINDOWEVENT_EXPOSED) *ok = present(s);
    }
    return true;
}

static int show(Shown *s)
{
    char octets[256];
    bool ok = present(s);
    while (ok) {
        struct pollfd look = {.fd = window_socket, .events = POLLIN};
        if (poll(&look, 1, look_ms) > 0) {
            ssize_t got;
            while ((got = recv(window_socket, octets, sizeof octets, MSG_DONTWAIT)) > 0) {
            }
            if (got == 0) return 0; /* the node has ended it, or has died */
        }
        ok = show_newest(s);
        struct timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        gamepad_step(&s->gamepad, (double)now.tv_sec + 1e-9 * (double)now.tv_nsec);
        if (ok && !take_events(s, &ok)) {
            say(WINDOW_CLOSED, 0, "");
            return 0;
        }
    }
    return failed("showing an image");
}

/* Without one that works all else goes on. */
static void open_gamepad(Shown *s, const char *axes, const char *address_port)
{
    char text[window_text_size];
    if (strcmp(axes, "none") == 0 || gamepad_open(&s->gamepad, address_port, strcmp(axes, "body") == 0, note)) return;
    snprintf(text, sizeof text, "gamepad: none turns the eye: %.120s", SDL_GetError());
    note(text);
}

int main(int argc, char **argv)
{
    Shown s = {.own = 0, .gamepad = {.socket = -1}};
    if (argc != 7 || !map(&s)) {
        fputs("pitviper-projector: `pitviper run --projector BAND` starts it\n", stderr);
        return 2;
    }
    signal(SIGINT, SIG_IGN); /* a terminal's Ctrl-C is for the node, which ends this program */
    SDL_SetMainReady();
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_MINIMIZE_ON_FOCUS_LOSS, "0");
    if (SDL_Init(SDL_INIT_VIDEO) != 0) return failed("opening the window system (DISPLAY, SDL_VIDEODRIVER)");
    /* SDL's last resort, where there is no window system */
    const char *driver = SDL_GetCurrentVideoDriver(), *asked = getenv("SDL_VIDEODRIVER");
    if ((!asked || !*asked) && (strcmp(driver, "offscreen") == 0 || strcmp(driver, "dummy") == 0)) {
        SDL_SetError("there is no window system here");
        return failed("opening a display");
    }
    SDL_DisableScreenSaver();
    const bool opened = open_window(&s, atoi(argv[1]), argv[2], argv[3], strcmp(argv[4], "on") == 0);
    if (opened) open_gamepad(&s, argv[5], argv[6]);
    const int code = opened ? show(&s) : failed("opening a window");
    gamepad_close(&s.gamepad);
    SDL_Quit();
    return code;
}
