/* render/frame/plant_price.c: what it costs in a frame that plants are simplified, or met in tables: in one pixel of
 * four hundred, drawn over the whole picture, four rays are traced and shaded as the frame has plants, and the same
 * rays with all of them in full detail: one ray in a hundred, of a frame of one ray a pixel. */

#include "render/frame/render.h"
#include "render/frame/frame_private.h"

enum {
    one_in = 400,
    side = 2,
    rays_a_pixel = side * side,
    pixels_a_task = 64,
    rays_a_task = pixels_a_task * rays_a_pixel
};

static const uint32_t stream = 0x7070; /* "pp" */

/* Of a task's rays: each quantity as the frame has plants, less in full detail. */
typedef struct PriceTask {
    double rays[price_quantities];    /* squares of rays' differences, summed */
    double pixels[price_quantities];  /* of pixels' mean differences */
    double squares[price_quantities]; /* of their squares */
    int    met, full[2];              /* rays that met a plant, either way; in full detail plants, and entities */
} PriceTask;

typedef struct Price {
    const Job *job;
    int        pixels; /* drawn */
    PriceTask *task;
} Price;

/* What rays met and what light they bring. */
typedef struct PriceRays {
    float value[price_quantities][rays_a_task];
} PriceRays;

/* Adds the pixel drawn of the k-th hundreds of the picture. Draws differ from frame to frame. */
static void add_drawn(PixelBlock *block, const Job *job, int k)
{
    const Picture *p = job->picture;
    const int      pixels = p->width * p->height, first = one_in * k;
    const int      some = pixels - first < one_in ? pixels - first : one_in;
    uint64_t       time;
    memcpy(&time, &job->scene.plants.t_s, sizeof time);
    const int at = first + (int)(random_uniform(time, stream, 0, (uint64_t)k) * some);
    pixels_add(block, at % p->width, at / p->width);
}

static void shade(PriceRays *out, Worker *w, const Job *job, int listed)
{
    const Hits *hits = &w->samples.hits;
    block_trace(w, job, job->request->bands, listed);
    shade_samples_sun(&w->shader, &job->scene, &w->samples);
    block_light(w, job);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const float *value = block_values(w, job, plane);
        if (value) memcpy(out->value[plane], value, (size_t)hits->count * sizeof *value);
        else memset(out->value[plane], 0, (size_t)hits->count * sizeof *value);
    }
    for (int i = 0; i < hits->count; i++) {
        out->value[price_cover][i] = hits->kind[i] == hit_plant;
        out->value[price_visible][i] = hits->entity[i] > 0;
    }
}

static void price_task(void *user, int worker, int index)
{
    const Price *price = user;
    const Job   *job = price->job;
    PriceTask   *t = &price->task[index];
    Worker      *w = job->worker[worker];
    Job          with_full = *job;
    PriceRays    used, full;
    double       box_px[4];
    with_full.scene.visibility = job->scene.full;
    w->block.n = side, w->block.pixels = w->block.columns = 0;
    for (int k = index * pixels_a_task; k < price->pixels && w->block.pixels < pixels_a_task; k++)
        add_drawn(&w->block, job, k);
    pixels_box(box_px, &w->block);
    const int listed = list_entities(w, job, box_px, false), pixels = w->block.pixels;
    shade(&used, w, job, listed);
    shade(&full, w, &with_full, listed);
    for (int q = 0; q < price_quantities; q++)
        for (int p = 0; p < pixels; p++) {
            double sum = 0;
            for (int i = p * rays_a_pixel; i < (p + 1) * rays_a_pixel; i++) {
                const double apart = (double)used.value[q][i] - (double)full.value[q][i];
                sum += apart, t->rays[q] += apart * apart;
            }
            t->pixels[q] += sum / rays_a_pixel, t->squares[q] += sum * sum / (rays_a_pixel * rays_a_pixel);
        }
    for (int i = 0; i < pixels * rays_a_pixel; i++) {
        t->met += used.value[price_cover][i] > 0 || full.value[price_cover][i] > 0;
        t->full[0] += full.value[price_cover][i] > 0, t->full[1] += full.value[price_visible][i] > 0;
    }
}

Status plant_price(PlantPrice *out, const Job *job, Pool *pool, Arena *arena)
{
    const int pixels = (job->picture->width * job->picture->height + one_in - 1) / one_in;
    const int tasks = (pixels + pixels_a_task - 1) / pixels_a_task;
    const int rays = pixels * rays_a_pixel;
    Price     price = {.job = job, .pixels = pixels, .task = arena_alloc(arena, (size_t)tasks, sizeof *price.task)};
    if (!price.task) return STATUS_NO_MEMORY;
    pool_run(pool, tasks, price_task, &price);
    *out = (PlantPrice){.rays = rays};
    int full[2] = {0};
    for (int t = 0; t < tasks; t++) {
        out->met += price.task[t].met;
        for (int k = 0; k < 2; k++) full[k] += price.task[t].full[k];
    }
    out->cover = (double)full[0] / rays, out->visible = (double)full[1] / rays;
    for (int q = 0; q < price_quantities; q++) {
        double of_rays = 0, of_pixels = 0, squares = 0;
        for (int t = 0; t < tasks; t++)
            of_rays += price.task[t].rays[q], of_pixels += price.task[t].pixels[q], squares += price.task[t].squares[q];
        const double mean = of_pixels / pixels, variance = squares / pixels - mean * mean;
        out->bias[q] = mean;
        out->bias_se[q] = pixels > 1 ? sqrt(fmax(variance, 0) / (pixels - 1)) : NAN;
        out->rms[q] = sqrt(of_rays / rays);
        /* products of the differences of two rays: of means over rays a pixel, less what single rays differ by */
        out->structure_square[q] = (rays_a_pixel * squares - of_rays / rays_a_pixel) / ((rays_a_pixel - 1) * pixels);
    }
    return STATUS_OK;
}
