// The classic algorithm of the smallest path tracer, written anew as a yardstick for speed: recursion with a branch
// in two at the first glass hits, double precision, a linear search over nine spheres, roulette by surface colour
// from the sixth hit on, a 48-bit linear congruential generator. One thread. Box filter, so that samples per pixel
// mean the same as on our side.
//
//   g++ -O3 -march=native -o smallpt smallpt.cpp                  # hits only
//   g++ -O3 -march=native -DDIRECT -o smallpt-direct smallpt.cpp  # and explicit sampling of the spherical lamp
//   ./smallpt WIDTH HEIGHT SPP [image.ppm]
//
// Prints one line of JSON: samples, CPU seconds, samples per CPU second, mean of the image (linear, unclamped).
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

struct Vec {
    double x, y, z;
    Vec(double x = 0, double y = 0, double z = 0) : x(x), y(y), z(z) {}
    Vec operator+(const Vec &b) const { return Vec(x + b.x, y + b.y, z + b.z); }
    Vec operator-(const Vec &b) const { return Vec(x - b.x, y - b.y, z - b.z); }
    Vec operator*(double s) const { return Vec(x * s, y * s, z * s); }
    Vec mult(const Vec &b) const { return Vec(x * b.x, y * b.y, z * b.z); }
    double dot(const Vec &b) const { return x * b.x + y * b.y + z * b.z; }
    Vec cross(const Vec &b) const { return Vec(y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x); }
    Vec unit() const { return *this * (1 / std::sqrt(dot(*this))); }
    double max() const { return x > y && x > z ? x : y > z ? y : z; }
};

struct Ray {
    Vec o, d;
};

enum Kind { DIFFUSE, MIRROR, GLASS };

const double EPS = 1e-4, PI = 3.14159265358979323846;

struct Sphere {
    double radius;
    Vec center, emission, color;
    Kind kind;
    double hit(const Ray &r) const { // distance, 0 for a miss
        Vec op = center - r.o;
        double b = op.dot(r.d), disc = b * b - op.dot(op) + radius * radius;
        if (disc < 0) return 0;
        disc = std::sqrt(disc);
        double t = b - disc;
        if (t > EPS) return t;
        t = b + disc;
        return t > EPS ? t : 0;
    }
};

const Sphere SCENE[] = {
    {1e5, Vec(1e5 + 1, 40.8, 81.6), Vec(), Vec(.75, .25, .25), DIFFUSE},
    {1e5, Vec(-1e5 + 99, 40.8, 81.6), Vec(), Vec(.25, .25, .75), DIFFUSE},
    {1e5, Vec(50, 40.8, 1e5), Vec(), Vec(.75, .75, .75), DIFFUSE},
    {1e5, Vec(50, 40.8, -1e5 + 170), Vec(), Vec(), DIFFUSE},
    {1e5, Vec(50, 1e5, 81.6), Vec(), Vec(.75, .75, .75), DIFFUSE},
    {1e5, Vec(50, -1e5 + 81.6, 81.6), Vec(), Vec(.75, .75, .75), DIFFUSE},
    {16.5, Vec(27, 16.5, 47), Vec(), Vec(.999, .999, .999), MIRROR},
    {16.5, Vec(73, 16.5, 78), Vec(), Vec(.999, .999, .999), GLASS},
    {600, Vec(50, 681.6 - .27, 81.6), Vec(12, 12, 12), Vec(), DIFFUSE},
};
const int COUNT = sizeof(SCENE) / sizeof(SCENE[0]);

// The generator of the classic: x' = 0x5DEECE66D x + 11 mod 2^48.
struct Random {
    uint64_t state;
    explicit Random(uint32_t seed) : state((uint64_t(seed) << 16) + 0x330E) {}
    double operator()() {
        state = (state * 0x5DEECE66DULL + 11) & ((1ULL << 48) - 1);
        return state * (1.0 / 281474976710656.0);
    }
};

static bool intersect(const Ray &r, double &t, int &id) {
    t = 1e20;
    for (int i = COUNT; i--;) {
        double d = SCENE[i].hit(r);
        if (d > 0 && d < t) {
            t = d;
            id = i;
        }
    }
    return t < 1e20;
}

static void basis(const Vec &w, Vec &u, Vec &v) {
    u = (std::fabs(w.x) > .1 ? Vec(0, 1, 0) : Vec(1, 0, 0)).cross(w).unit();
    v = w.cross(u);
}

static Vec radiance(const Ray &r, int depth, Random &rnd, bool seesLamp) {
    double t;
    int id = 0;
    if (!intersect(r, t, id)) return Vec();
    const Sphere &s = SCENE[id];
    Vec x = r.o + r.d * t, n = (x - s.center).unit(), nl = n.dot(r.d) < 0 ? n : n * -1, f = s.color;
    Vec emitted = seesLamp ? s.emission : Vec();
    double p = f.max();
    if (++depth > 5 || p == 0) {
        if (depth > 100 || !(rnd() < p)) return emitted; // the guard keeps the stack finite
        f = f * (1 / p);
    }

    if (s.kind == DIFFUSE) {
        Vec u, v, direct;
        basis(nl, u, v);
#ifdef DIRECT
        for (int i = 0; i < COUNT; i++) {
            const Sphere &lamp = SCENE[i];
            if (lamp.emission.max() <= 0) continue;
            Vec w = lamp.center - x, su, sv;
            double cosMax = std::sqrt(1 - lamp.radius * lamp.radius / w.dot(w));
            w = w.unit();
            basis(w, su, sv);
            double cosA = 1 - rnd() * (1 - cosMax), sinA = std::sqrt(1 - cosA * cosA), phi = 2 * PI * rnd();
            Vec l = (su * (std::cos(phi) * sinA) + sv * (std::sin(phi) * sinA) + w * cosA).unit();
            double distance;
            int at = 0;
            if (l.dot(nl) > 0 && intersect(Ray{x, l}, distance, at) && at == i)
                direct = direct + f.mult(lamp.emission * (l.dot(nl) * 2 * (1 - cosMax)));
        }
        const bool next = false;
#else
        const bool next = true;
#endif
        double phi = 2 * PI * rnd(), r2 = rnd(), r2s = std::sqrt(r2);
        Vec d = (u * (std::cos(phi) * r2s) + v * (std::sin(phi) * r2s) + nl * std::sqrt(1 - r2)).unit();
        return emitted + direct + f.mult(radiance(Ray{x, d}, depth, rnd, next));
    }

    Ray reflected{x, r.d - n * (2 * n.dot(r.d))};
    if (s.kind == MIRROR) return emitted + f.mult(radiance(reflected, depth, rnd, true));

    bool into = n.dot(nl) > 0;
    double nc = 1, nt = 1.5, eta = into ? nc / nt : nt / nc, ddn = r.d.dot(nl);
    double cos2t = 1 - eta * eta * (1 - ddn * ddn);
    if (cos2t < 0) return emitted + f.mult(radiance(reflected, depth, rnd, true));
    Vec tdir = (r.d * eta - n * ((into ? 1 : -1) * (ddn * eta + std::sqrt(cos2t)))).unit();
    double a = nt - nc, b = nt + nc, r0 = a * a / (b * b), c = 1 - (into ? -ddn : tdir.dot(n));
    double re = r0 + (1 - r0) * c * c * c * c * c, tr = 1 - re;
    if (depth > 2) { // one of the two
        double q = .25 + .5 * re;
        return emitted + f.mult(rnd() < q ? radiance(reflected, depth, rnd, true) * (re / q)
                                          : radiance(Ray{x, tdir}, depth, rnd, true) * (tr / (1 - q)));
    }
    return emitted + f.mult(radiance(reflected, depth, rnd, true) * re + radiance(Ray{x, tdir}, depth, rnd, true) * tr);
}

int main(int argc, char **argv) {
    if (argc < 4) {
        std::fprintf(stderr, "usage: smallpt WIDTH HEIGHT SPP [image.ppm]\n");
        return 2;
    }
    const int width = std::atoi(argv[1]), height = std::atoi(argv[2]), spp = std::atoi(argv[3]);
    if (width < 1 || height < 1 || spp < 1) return 2;
    const Vec eye(50, 52, 295.6), toward = Vec(0, -0.042612, -1).unit();
    const Vec cx(width * .5135 / height), cy = cx.cross(toward).unit() * .5135;
    std::vector<Vec> image(size_t(width) * height);

    const std::clock_t start = std::clock();
    for (int y = 0; y < height; y++) {
        Random rnd(uint32_t(y) * 2654435761u + 1);
        for (int x = 0; x < width; x++) {
            Vec sum;
            for (int s = 0; s < spp; s++) {
                Vec d = cx * ((x + rnd()) / width - .5) + cy * (.5 - (y + rnd()) / height) + toward;
                // The direction is made a unit vector before the start of the ray is moved along it. The classic
                // writes Ray(eye + d*140, d.norm()), where norm() changes d and the order is not specified: g++
                // normalises first. The other order starts rays above the ceiling and brightens the mean by 18 %.
                d = d.unit();
                sum = sum + radiance(Ray{eye + d * 140, d}, 0, rnd, true);
            }
            image[size_t(y) * width + x] = sum * (1.0 / spp);
        }
    }
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;

    Vec mean;
    for (const Vec &p : image) mean = mean + p * (1.0 / image.size());
    const double samples = double(width) * height * spp;
    std::printf("{\"samples\": %.0f, \"cpu_seconds\": %.3f, \"samples_per_cpu_second\": %.0f, \"mean\": %.5f}\n", samples,
                seconds, samples / seconds, (mean.x + mean.y + mean.z) / 3);
    if (argc > 4) {
        if (std::FILE *file = std::fopen(argv[4], "wb")) {
            std::fprintf(file, "P6\n%d %d\n255\n", width, height);
            for (const Vec &p : image)
                for (double v : {p.x, p.y, p.z}) {
                    double c = v < 0 ? 0 : v > 1 ? 1 : v;
                    std::fputc(int(std::pow(c, 1 / 2.2) * 255 + .5), file);
                }
            std::fclose(file);
        }
    }
    return 0;
}
