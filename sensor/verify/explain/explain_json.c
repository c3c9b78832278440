/* sensor/verify/explain/explain_json.c: a pixel explained as JSON: every sample, with all figures as they are. */
#include "sensor/verify/explain/explain_private.h"

#include "sensor/frame/json_object.h"

static void set(json_t *object, const char *key, double value) { json_set_number(object, key, value); }

static void set_index(json_t *object, const char *key, long long value)
{
    json_object_set_new(object, key, json_integer((json_int_t)value));
}

static json_t *floats(const float *value, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(list, json_real((double)value[i]));
    return list;
}

static json_t *light_json(const PixelLight *l, bool met, AirBand channel)
{
    json_t *light = json_object();
    if (met) {
        if (channel >= AIR_MWIR)
            set(light, "emitted", (double)l->emitted), set(light, "transmittance", (double)l->transmittance);
        set(light, "reflected", (double)l->reflected);
        set(light, "reflected_sky", (double)l->reflected_sky);
        set(light, "reflected_ground", (double)l->reflected_ground);
        if (l->lamps > 0) set(light, "lamps", (double)l->lamps);
        set(light, "air_transmittance", (double)l->air_transmittance);
        set(light, "sunlit", (double)l->sunlit);
        set(light, "sun_transmittance", (double)l->sun_transmittance);
    } else {
        set(light, "beyond", l->beyond);
        set(light, "beyond_transmittance", (double)l->beyond_transmittance);
        set(light, "disc", l->disc);
    }
    set(light, "path", (double)l->path);
    if (l->smoky)
        set(light, "smoke_transmittance", (double)l->smoke_transmittance), set(light, "smoke", (double)l->smoke);
    set(light, "sum", (double)pixel_light_sum(l, channel, met));
    return light;
}

static json_t *heat_json(const Explained *e, const PixelSample *s)
{
    json_t *heat = json_object();
    set(heat, "temp_k", (double)s->temp_k);
    set(heat, "air_k", (double)s->air_k);
    set(heat, "heat_k", (double)s->still_k - (double)s->air_k);
    set(heat, "sun_or_photograph_k", (double)s->sunlit_k - (double)s->still_k);
    set(heat, "detail_k", (double)s->detailed_k - (double)s->sunlit_k);
    set(heat, "far_woods_k", (double)s->temp_k - (double)s->detailed_k);
    if (s->kind == hit_scenery) explain_scenery_json(heat, &s->scenery);
    if (s->patches == 0) return heat;
    json_t *patches = json_array();
    for (int k = 0; k < s->patches; k++) {
        json_t *patch = json_object();
        set_index(patch, "patch", s->patch[k].index);
        json_object_set_new(
            patch, "role",
            json_string(heat_role_name(e->scene->world.patches->of[s->model].patch[s->patch[k].index].role)));
        set(patch, "share", (double)s->patch[k].share);
        set(patch, "temp_k", (double)s->patch[k].temp_k);
        json_array_append_new(patches, patch);
    }
    json_object_set_new(heat, "patches", patches);
    return heat;
}

static json_t *sample_json(const Explained *e, const PixelRecord *r, int i)
{
    const PixelSample *s = &r->sample[i];
    const bool         met = s->range_m < INFINITY;
    json_t            *sample = json_object(), *lights = json_object(), *weights = json_object();
    char               name[3 * model_name_size];
    explain_surface(name, sizeof name, e, s);
    set_index(sample, "group", s->group);
    set(sample, "share", s->weight);
    for (int k = 0; k < e->planes; k++)
        if (e->plane[k].record == r) set(weights, e->plane[k].name, e->plane[k].weight[i]);
    json_object_set_new(sample, "weight", weights);
    json_set_text(sample, "surface", name, strlen(name));
    if (met) {
        const char *material = e->scene->world.materials.material[s->material].name;
        json_set_text(sample, "material", material, strlen(material));
        set(sample, "range_m", s->range_m);
        json_object_set_new(sample, "p_enu_m", json_number_list(s->p_enu, 3));
        json_object_set_new(sample, "normal_enu", floats(s->n_enu, 3));
        set_index(sample, "entity", s->entity);
        set_index(sample, "part", s->part);
        set_index(sample, "instance", s->plant);
        set(sample, "sun", (double)s->sun);
        if (isfinite(s->temp_k)) json_object_set_new(sample, "temperature", heat_json(e, s));
    }
    for (int c = 0; c < r->channels; c++) {
        const AirBand channel = r->channel[c].channel;
        if (s->channels >> channel & 1)
            json_object_set_new(lights, channel_in(channel)->name, light_json(&s->light[channel], met, channel));
    }
    json_object_set_new(sample, "light", lights);
    if (s->has_radar) json_object_set_new(sample, "radar", floats(s->radar, radar_bounces));
    return sample;
}

static json_t *step_json(const Explained *e, const PixelRecord *r, int k, const ExplainedPlane *p)
{
    static const char *const kind[] = {"mean", "smoothed", "beside", "before", "target"};
    const PixelStep         *s = &r->step[k];
    json_t                  *step = json_object();
    json_object_set_new(step, "kind", json_string(kind[s->kind]));
    if (s->group) set_index(step, "group", s->group);
    if (s->kind == PIXEL_MEAN) {
        set_index(step, "rays_a_side", s->n);
        json_object_set_new(step, "split", json_boolean(s->several));
    }
    if (s->kind != PIXEL_SMOOTHED && s->kind != PIXEL_TARGET) set(step, "share", s->share);
    if (s->kind == PIXEL_SMOOTHED) {
        json_object_set_new(step, "weights", floats(s->weight, 9));
        json_object_set_new(step, "values", floats(s->value[p->recorded_plane], 9));
    }
    if (s->kind >= PIXEL_BEFORE) {
        char id[dis_id_text_size];
        dis_entity_id_text(id, e->scene->snapshot.entity[s->entity].id);
        json_object_set_new(step, "entity", json_string(id));
    }
    set(step, "value", (double)pixel_record_value(NULL, NULL, r, p->recorded_plane, k + 1));
    return step;
}

static json_t *plane_json(const Explained *e, const ExplainedPlane *p)
{
    json_t *plane = json_object(), *terms = json_object(), *steps = json_array();
    json_object_set_new(plane, "plane", json_string(p->name));
    json_object_set_new(plane, "unit", json_string(p->unit));
    if (!p->is_radar) json_object_set_new(plane, "channel", json_string(channel_in(p->channel)->name));
    set(plane, "value", (double)p->value);
    set(plane, "sum", (double)p->sum);
    json_object_set_new(plane, "same", json_boolean(memcmp(&p->sum, &p->value, sizeof p->sum) == 0));
    set(plane, "apparent_temp_k", p->temp_k);
    for (int t = 0; t < EXPLAIN_TERMS; t++)
        if ((t >= EXPLAIN_BOUNCES) == p->is_radar) set(terms, explain_term_name[t], p->term[t]);
    json_object_set_new(plane, "terms", terms);
    set_index(plane, "samples_of", p->record - e->record);
    for (int k = 0; k < p->record->steps; k++)
        if (p->record->step[k].planes >> p->recorded_plane & 1)
            json_array_append_new(steps, step_json(e, p->record, k, p));
    json_object_set_new(plane, "steps", steps);
    return plane;
}

static json_t *band_json(const ExplainedBand *b)
{
    static const char *const stage[chain_stages] = {"electrons", "small_targets", "optics",     "lines", "gain",
                                                    "noise",     "pattern",       "ac_coupled", "counts"};
    json_t                  *band = json_object(), *channels = json_array();
    set(band, "black", b->level.low), set(band, "white", b->level.high);
    if (b->has_chain) set(band, "exposure", b->watch.exposure), set_index(band, "defect", b->watch.defect);
    for (int c = 0; c < b->channels; c++) {
        json_t *channel = json_object();
        for (int s = 0; s < chain_stages; s++)
            if (b->watch.has[c] >> s & 1) set(channel, stage[s], b->watch.value[c][s]);
        set(channel, "displayed", (double)b->displayed[c]);
        set_index(channel, "grey", b->grey[c]);
        json_array_append_new(channels, channel);
    }
    json_object_set_new(band, "channels", channels);
    return band;
}

Status explain_print_json(FILE *to, const Explained *e)
{
    json_t *root = json_object(), *planes = json_array(), *samples = json_array(), *bands = json_object();
    set_index(root, "frame", e->file->frame);
    json_set_text(root, "host", e->file->host, strlen(e->file->host));
    set(root, "time_s", e->file->time_s);
    set_index(root, "x", e->x), set_index(root, "y", e->y);
    set_index(root, "width", e->picture->width), set_index(root, "height", e->picture->height);
    json_object_set_new(root, "as_saved", json_boolean(e->differ == 0));
    for (int k = 0; k < e->planes; k++) json_array_append_new(planes, plane_json(e, &e->plane[k]));
    for (int n = 0; n < pixel_records; n++) {
        json_t *list = json_array();
        for (int i = 0; i < e->record[n].samples; i++) json_array_append_new(list, sample_json(e, &e->record[n], i));
        json_array_append_new(samples, list);
    }
    for (int b = 0; b < BAND_COUNT; b++)
        if (e->band[b].there) json_object_set_new(bands, band_name((Band)b), band_json(&e->band[b]));
    json_object_set_new(root, "planes", planes);
    json_object_set_new(root, "samples", samples);
    json_object_set_new(root, "detector", bands);
    const bool ok = json_dumpf(root, to, JSON_INDENT(1)) == 0 && fputc('\n', to) != EOF;
    json_decref(root);
    return ok ? STATUS_OK : STATUS_IO;
}
