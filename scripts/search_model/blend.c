// Front-to-back blending of sorted splats on the CPU; the same sums as the Triton kernel in
// compositor.py, which compiles this file where there is no GPU.
#include <math.h>
#include <stddef.h>

// splats [images, count, 11]: centre, conic, radii, opacity, colour. image [images, 4, size, size].
void blend(const float *splats, float *image, long images, long count, long size) {
    const long plane = size * size;
    for (long i = 0; i < images; i++) {
        float *red = image + i * 4 * plane, *green = red + plane, *blue = green + plane;
        float *transmittance = blue + plane; // becomes alpha at the end
        for (long p = 0; p < plane; p++) {
            red[p] = green[p] = blue[p] = 0.0f;
            transmittance[p] = 1.0f;
        }
        const float *s = splats + i * count * 11;
        for (long n = 0; n < count; n++, s += 11) {
            if (!(s[5] > 0.0f && s[6] > 0.0f)) continue;
            const long left = (long)fmaxf(floorf(s[0] - s[5]), 0.0f);
            const long right = (long)fminf(ceilf(s[0] + s[5]), (float)size);
            const long top = (long)fmaxf(floorf(s[1] - s[6]), 0.0f);
            const long bottom = (long)fminf(ceilf(s[1] + s[6]), (float)size);
            for (long y = top; y < bottom; y++) {
                const float dy = (float)y + 0.5f - s[1];
                for (long x = left; x < right; x++) {
                    const long p = y * size + x;
                    const float dx = (float)x + 0.5f - s[0];
                    const float power = -0.5f * (s[2] * dx * dx + s[4] * dy * dy) - s[3] * dx * dy;
                    const float alpha = fminf(s[7] * expf(power), 0.99f);
                    if (alpha < 1.0f / 255.0f) continue;
                    const float weight = alpha * transmittance[p];
                    red[p] += weight * s[8];
                    green[p] += weight * s[9];
                    blue[p] += weight * s[10];
                    transmittance[p] -= weight;
                }
            }
        }
        for (long p = 0; p < plane; p++) transmittance[p] = 1.0f - transmittance[p];
    }
}
