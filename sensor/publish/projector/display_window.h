/* sensor/publish/projector/display_window.h: the program with a window on a display (pitviper-projector), seen from the
 * node: it is given images, shows the newest, and says when it was flipped.
 *
 * One thread gives images; a thread of the window's own takes what it says. */
#ifndef SENSOR_PUBLISH_PROJECTOR_DISPLAY_WINDOW_H
#define SENSOR_PUBLISH_PROJECTOR_DISPLAY_WINDOW_H

#include "sensor/frame/publish_counters.h"
#include "pitviper.h"

typedef struct DisplayWindow DisplayWindow;

typedef struct DisplayWindowOf {
    int         width, height; /* of images, px */
    int         display;
    const char *size;  /* `full`, or WIDTHxHEIGHT */
    const char *scale; /* `one`, `whole`, `fit` */
    bool        vsync;
    const char *gamepad; /* `none`, or whose axes a gamepad's poses are of: `level`, `body` */
    const char *head;    /* ADDRESS:PORT that these go to */
    /* An image was flipped at wall_clock_s at_s, or is never shown; the one from the thread of the window,
     * the other from that which gives images. NULL: not told. */
    void (*flipped)(void *user, uint32_t number, double at_s);
    void (*dropped)(void *user, uint32_t number);
    void *user;
} DisplayWindowOf;

/* Waits until the window is there. STATUS_UNSUPPORTED, STATUS_IO, logged with what to do: built without SDL2; no
 * display. */
Status display_window_open(DisplayWindow **out, const DisplayWindowOf *of);
/* The image to fill, [height][width] of 0x00RRGGBB. */
uint32_t *display_window_fill(DisplayWindow *window);
/* Shows that image as the newest, by a number above those before. Never waits. False: the window is gone. */
bool display_window_show(DisplayWindow *window, uint32_t number);
/* Waits until the image of that number or a later one was flipped, wait_s at most, or the window is gone. False: it was
 * not. */
bool display_window_wait(DisplayWindow *window, uint32_t number, double wait_s);
/* Ends it; images on their way are dropped. NULL is valid. */
void display_window_close(DisplayWindow *window, ProjectorCounters *counters);

#endif
