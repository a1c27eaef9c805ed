// As much of GLSL and HLSL as exported skies use, for a C++ compiler: single precision throughout.
#include <cmath>

struct vec3 {
    float x, y, z;
    vec3(float x, float y, float z) : x(x), y(y), z(z) {}
};
typedef vec3 float3;
static vec3 operator*(float k, vec3 v) { return vec3(k * v.x, k * v.y, k * v.z); }
static vec3 operator/(vec3 v, float k) { return vec3(v.x / k, v.y / k, v.z / k); }
static void operator+=(vec3 &v, vec3 more) { v = vec3(v.x + more.x, v.y + more.y, v.z + more.z); }

static float exp(float x) { return std::exp(x); }
static float sqrt(float x) { return std::sqrt(x); }
static float sin(float x) { return std::sin(x); }
static float cos(float x) { return std::cos(x); }
static float tan(float x) { return std::tan(x); }
static float pow(float x, float y) { return std::pow(x, y); }
static float min(float x, float y) { return x < y ? x : y; }
static float max(float x, float y) { return x > y ? x : y; }
static vec3 max(vec3 v, float y) { return vec3(max(v.x, y), max(v.y, y), max(v.z, y)); }
static float clamp(float x, float low, float high) { return min(max(x, low), high); }
