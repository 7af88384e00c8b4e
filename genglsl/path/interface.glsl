// SPDX-License-Identifier: Apache-2.0
// Functions that a path tracer calls (docs/path_tracing.md). wo and wi are unit vectors that point
// away from the surface.

void path_ask(int asked, Point p, vec3 wo, vec3 wi, vec3 u)
{
    path_asked = asked;
    path_wo = wo;
    vec3 both = wo + wi;
    path_wi = dot(both, both) > 0.0 ? wi : wi + 1e-6 * p.tangent;  // opposite directions have no half vector
    path_u = u;
    path_inside = p.inside;
    path_thin = material_is_thin_walled;
    path_root = vec3(0.0);
    path_place(p);
    path_material();
}

// The BSDF f times cos(theta_i) times the opacity.
vec3 material_evaluate(Point p, vec3 wo, vec3 wi)
{
    path_ask(PATH_VALUE, p, wo, wi, vec3(0.0));
    return path_root * path_out.a;
}

// Density in 1/sr with which material_sample draws wi. The integral is the probability of a draw
// with a positive pdf.
float material_pdf(Point p, vec3 wo, vec3 wi)
{
    path_ask(PATH_PDF, p, wo, wi, vec3(0.0));
    return path_root.x > 0.0 ? path_root.y * path_out.a : 0.0;
}

// Draws wi with random numbers u in [0, 1). `weight` is f cos(theta_i) / pdf. The result is false
// if the path ends. If light passes straight on, wi is -wo and pdf is 0, since densities
// exclude this light.
bool material_sample(Point p, vec3 wo, vec3 u, out vec3 wi, out vec3 weight, out float pdf)
{
    wi = -wo;
    weight = vec3(1.0);
    pdf = 0.0;

    // Because the queries share a loop, compilers inline the material only once.
    for (int asked = PATH_DRAW; asked >= PATH_VALUE; --asked)
    {
        path_ask(asked, p, wo, wi, u);
        if (asked == PATH_DRAW)
        {
            if (path_u.z >= path_out.a)
            {
                return true;
            }
            if (!(path_root.x > 0.0) || path_root.y > 2.0)
            {
                return false;
            }
            wi = path_unpacked(path_root.yz);
        }
        else if (asked == PATH_PDF)
        {
            pdf = path_root.y * path_out.a;
        }
    }
    weight = path_root * path_out.a / pdf;
    return pdf > 0.0;
}

// Opacity for shadow rays: the fraction of light that does not pass straight on.
float material_shadow(Point p, vec3 wo)
{
    path_ask(PATH_NOTHING, p, wo, wo, vec3(0.0));
    return path_out.a;
}

// Radiance that the surface emits towards wo.
vec3 material_emitted(Point p, vec3 wo)
{
    path_ask(PATH_NOTHING, p, wo, wo, vec3(0.0));
    return path_out.rgb;
}
