/* sensor/publish/projector/window_wire.h: what the node and the program with the window (pitviper-projector) share:
 * images in shared memory, of which the newest is shown, and messages over a socket.
 *
 * Three images: one is filled, one is shown, and one waits. `waiting` names the third and whether it is fresh; the node
 * puts a filled one there, and the window takes it if it is fresh, both by exchanging it for their own. So neither
 * waits for the other, and the node learns of every image that was never taken: it gets it back fresh.
 *
 * The window writes what it did with an image, a message each; the node writes an octet for each image, so that the
 * window wakes up, and closes its end to end it. */
#ifndef SENSOR_PUBLISH_PROJECTOR_WINDOW_WIRE_H
#define SENSOR_PUBLISH_PROJECTOR_WINDOW_WIRE_H

#include <stddef.h>
#include <stdint.h>

enum { window_images = 3, window_fresh = 4 /* a bit beside the image's number */, window_text_size = 200 };
enum { window_socket = 3, window_memory = 4 }; /* file descriptors in the window's program */
enum { window_header_octets = 4096 };

typedef struct WindowShared {
    uint32_t waiting; /* by atomic exchange alone: 0 .. window_images - 1, | window_fresh */
    uint32_t number[window_images];
    int32_t  width, height;
} WindowShared;

/* An image is [height][width] of 0x00RRGGBB, rows top down. */
static inline size_t window_image_octets(int width, int height) { return (size_t)width * (size_t)height * 4; }
static inline size_t window_octets(int width, int height)
{
    return window_header_octets + window_images * window_image_octets(width, height);
}
static inline uint32_t *window_image(WindowShared *shared, int width, int height, uint32_t image)
{
    return (uint32_t *)(void *)((unsigned char *)shared + window_header_octets +
                                image * window_image_octets(width, height));
}

/* The node gives the image that it has filled, and gets another to fill. undone: that one was given before, and never
 * taken. */
static inline uint32_t window_give(WindowShared *shared, uint32_t own, int *undone)
{
    const uint32_t before = __atomic_exchange_n(&shared->waiting, own | window_fresh, __ATOMIC_ACQ_REL);
    *undone = (before & window_fresh) != 0;
    return (before & ~(uint32_t)window_fresh) % window_images; /* whatever another program has written there */
}
static inline int window_is_fresh(const WindowShared *shared)
{
    return (__atomic_load_n(&shared->waiting, __ATOMIC_ACQUIRE) & window_fresh) != 0;
}
/* The window takes the image that waits for its own, which it no longer shows; only where one is fresh. */
static inline uint32_t window_take(WindowShared *shared, uint32_t own)
{
    return __atomic_exchange_n(&shared->waiting, own, __ATOMIC_ACQ_REL) & ~(uint32_t)window_fresh;
}

typedef enum WindowEvent {
    WINDOW_OPENED = 1, /* text: what it is shown by and where; number: refresh rate, mHz, 0: not known */
    WINDOW_FLIPPED,    /* number: of the image; time_ns: CLOCK_MONOTONIC when its flip was done */
    WINDOW_FAILED,     /* text: why; it ends */
    WINDOW_CLOSED,     /* by its user; it ends */
    WINDOW_NOTED       /* text: what its user may want to know */
} WindowEvent;

typedef struct WindowMessage {
    uint32_t event, number;
    uint32_t newer, zero; /* of a flip: 1 where a newer image was there by then */
    int64_t  time_ns;
    char     text[window_text_size];
} WindowMessage;

#endif
