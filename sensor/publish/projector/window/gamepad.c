/* sensor/publish/projector/window/gamepad.c: from sticks to poses of the operator's eye. */
#include "sensor/publish/projector/window/gamepad.h"

#include "dis/network/host_port.h"

#include <sys/socket.h>
#include <unistd.h>

static const double dead = 0.08;                        /* a stick never rests at 0; share of its way */
static const double rate_dps = 30;                      /* at full deflection, with zoom 1 */
static const double zoom_of_second = 2;                 /* a second at full deflection doubles it */
static const double zoom_least = 0.05, zoom_most = 100; /* as in a datagram */

static int connect_to(const char *address_port)
{
    HostPort to;
    if (!host_port_parse(&to, address_port)) return -1;
    const int s = socket(to.any.sa_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (s < 0 || connect(s, &to.any, host_port_size(&to)) == 0) return s; /* 0.0.0.0 is this machine */
    close(s);
    return -1;
}

bool gamepad_open(Gamepad *out, const char *address_port, bool relative, void (*say)(const char *text))
{
    *out = (Gamepad){.socket = -1, .say = say, .looked_s = -INFINITY, .stepped_s = NAN};
    out->pose = (HeadPose){.flags = relative ? HEAD_RELATIVE : 0, .zoom = 1};
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1"); /* whatever has the keyboard's focus */
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) return false;
    out->socket = connect_to(address_port);
    return out->socket >= 0 || (SDL_SetError("%s cannot be sent to", address_port), false);
}

/* Once a second: the first that is there. */
static void look_for_one(Gamepad *g, double now_s)
{
    char text[160];
    if (g->pad || now_s - g->looked_s < 1) return;
    g->looked_s = now_s;
    for (int i = 0; i < SDL_NumJoysticks() && !g->pad; i++)
        if (SDL_IsGameController(i)) g->pad = SDL_GameControllerOpen(i);
    if (!g->pad) return;
    const char *name = SDL_GameControllerName(g->pad);
    snprintf(text, sizeof text, "gamepad: %.100s turns the eye", name ? name : "one without a name");
    g->say(text);
}

/* -1 .. 1, from the edge of the dead zone on. */
static double stick(const Gamepad *g, SDL_GameControllerAxis axis)
{
    const double v = SDL_GameControllerGetAxis(g->pad, axis) / 32767.0, size = fmin(fabs(v), 1);
    return size <= dead ? 0 : copysign((size - dead) / (1 - dead), v);
}

static double wrapped(double deg) { return deg - 360 * floor((deg + 180) / 360); }

static void turn(Gamepad *g, double step_s)
{
    HeadPose    *p = &g->pose;
    const double step_deg = rate_dps * step_s / p->zoom;
    p->yaw_deg = wrapped(p->yaw_deg + step_deg * stick(g, SDL_CONTROLLER_AXIS_LEFTX));
    p->pitch_deg = fmax(-90, fmin(90, p->pitch_deg - step_deg * stick(g, SDL_CONTROLLER_AXIS_LEFTY)));
    p->zoom *= pow(zoom_of_second, -step_s * stick(g, SDL_CONTROLLER_AXIS_RIGHTY));
    p->zoom = fmax(zoom_least, fmin(zoom_most, p->zoom));
    p->buttons = 0;
    for (int b = 0; b < SDL_CONTROLLER_BUTTON_MAX && b < 32; b++)
        if (SDL_GameControllerGetButton(g->pad, (SDL_GameControllerButton)b)) p->buttons |= 1u << b;
    if (SDL_GameControllerGetButton(g->pad, SDL_CONTROLLER_BUTTON_BACK)) p->yaw_deg = p->pitch_deg = 0, p->zoom = 1;
}

void gamepad_step(Gamepad *g, double now_s)
{
    static const double least_s = 0.01, most_s = 0.25; /* most: an image that took long turns it no further */
    uint8_t             out[head_octets_most];
    if (g->socket < 0 || now_s - g->stepped_s < least_s) return;
    const double step_s = isnan(g->stepped_s) ? 0 : fmin(now_s - g->stepped_s, most_s);
    g->stepped_s = now_s;
    SDL_GameControllerUpdate();
    if (g->pad && !SDL_GameControllerGetAttached(g->pad)) {
        SDL_GameControllerClose(g->pad);
        g->pad = NULL;
        g->say("gamepad: it is gone; the eye stays where it looks");
    }
    look_for_one(g, now_s);
    if (!g->pad) return;
    turn(g, step_s);
    g->pose.sequence++;
    g->pose.time_us = (uint64_t)llround(1e6 * now_s);
    send(g->socket, out, head_pose_write(out, &g->pose), MSG_NOSIGNAL); /* lost, as any datagram may be */
}

void gamepad_close(Gamepad *g)
{
    if (g->pad) SDL_GameControllerClose(g->pad);
    if (g->socket >= 0) close(g->socket);
}
