/* tests/tools/virtual_pad.c: preloaded into pitviper-projector: a gamepad of SDL2's that is not there. It is attached
 * with SDL's gamepads, and set before the window system's events are taken, as the file $VIRTUAL_PAD says: left x, left
 * y, right x, right y, -32768 .. 32767, and a mask of buttons in hexadecimal; `gone` detaches it. */
#include <SDL.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int           device = -1;
static SDL_Joystick *pad;

static void *next(const char *name) { return dlsym(RTLD_NEXT, name); }

int SDL_InitSubSystem(Uint32 flags)
{
    int (*real)(Uint32) = (int (*)(Uint32))next("SDL_InitSubSystem");
    const int result = real(flags);
    if (result != 0 || !(flags & SDL_INIT_GAMECONTROLLER)) return result;
    device = SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                       SDL_CONTROLLER_BUTTON_MAX, 0);
    if (device >= 0) pad = SDL_JoystickOpen(device);
    return result;
}

static void set(const char *line)
{
    int      axis[4];
    unsigned buttons;
    if (strncmp(line, "gone", 4) == 0) {
        SDL_JoystickClose(pad);
        SDL_JoystickDetachVirtual(device);
        pad = NULL;
    } else if (sscanf(line, "%d %d %d %d %x", &axis[0], &axis[1], &axis[2], &axis[3], &buttons) == 5) {
        for (int a = 0; a < 4; a++) SDL_JoystickSetVirtualAxis(pad, a, (Sint16)axis[a]);
        for (int b = 0; b < SDL_CONTROLLER_BUTTON_MAX; b++) SDL_JoystickSetVirtualButton(pad, b, buttons >> b & 1);
    }
}

int SDL_PollEvent(SDL_Event *event)
{
    int (*real)(SDL_Event *) = (int (*)(SDL_Event *))next("SDL_PollEvent");
    char        line[80];
    const char *path = getenv("VIRTUAL_PAD");
    FILE       *file = pad && path ? fopen(path, "r") : NULL;
    if (file && fgets(line, sizeof line, file)) set(line);
    if (file) fclose(file);
    return real(event);
}
