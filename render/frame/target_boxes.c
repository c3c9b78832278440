/* render/frame/target_boxes.c: where targets lie on the image. */
#include "render/frame/target_boxes.h"

/* Only for targets whose bounding sphere may be visible: the vertices of others are not tested. */
void project_target(void *user, int worker, int index)
{
    (void)worker;
    const Job            *job    = user;
    TargetPixels         *target = &job->boxes[index];
    const View           *view   = &job->request->view;
    const SnapshotEntity *entity = &job->scene.snapshot->entity[index];
    double                p_enu[3], offset_enu[3], p_cam[3];
    if (index == job->request->hidden_entity || entity->model < 0) return;
    enu_from_ecef(p_enu, &job->scene.world->frame, entity->p_ecef);
    v3_sub(offset_enu, p_enu, view->p_enu);
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    const double radius_m = catalog_model(job->scene.world->catalog, entity->model)->radius_m;
    if (!(p_cam[2] > -radius_m)) return;
    /* half a picture and the sphere, in the plane of the sphere's far side: generous, never too tight */
    const double depth_m = p_cam[2] + radius_m;
    double       half[2], box[4];
    view_half_tangents(half, view);
    if (fabs(p_cam[0]) - radius_m > depth_m * half[0] || fabs(p_cam[1]) - radius_m > depth_m * half[1]) return;
    if (!visibility_project_box(box, job->scene.visibility, view, index)) return;
    if (!(box[2] > 0 && box[0] < view->width && box[3] > 0 && box[1] < view->height)) return;
    target->projected = true;
    memcpy(target->projected_box, box, sizeof box);
}
