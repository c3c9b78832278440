/* sensor/publish/projector/window/gamepad.h: a gamepad of SDL2's that turns the operator's eye: its sticks as the poses
 * of a head tracker (dis/head/head_pose.h), by UDP to where the node takes them. In the window's program, which has
 * SDL. */
#ifndef SENSOR_PUBLISH_PROJECTOR_WINDOW_GAMEPAD_H
#define SENSOR_PUBLISH_PROJECTOR_WINDOW_GAMEPAD_H

#include "dis/head/head_pose.h"

#include <SDL.h>

typedef struct Gamepad {
    int                 socket; /* -1: there is none, and nothing is done */
    SDL_GameController *pad;    /* NULL: none is there */
    double              looked_s, stepped_s;
    HeadPose            pose;
    void (*say)(const char *text); /* that one is there, or gone */
} Gamepad;

/* Sends to ADDRESS:PORT, numeric (IPv6 in brackets), from the first step on at which a gamepad is there; angles are of
 * north and level, or with relative of what carries the eye. False: SDL_GetError says why. */
bool gamepad_open(Gamepad *out, const char *address_port, bool relative, void (*say)(const char *text));
/* Turns the pose by the sticks for as long as it is since the step before, and sends it; a step is of 10 ms or more,
 * else nothing is done. now_s: CLOCK_MONOTONIC. */
void gamepad_step(Gamepad *gamepad, double now_s);
void gamepad_close(Gamepad *gamepad);

#endif
