"""Names of swept parameters that a program may have as arguments."""

import keyword
import re
from collections.abc import Iterable

from .description import BUILT_IN, VECTORS, Function


# Of C, C++, GLSL, HLSL and JavaScript; those of Python come from Python.
_RESERVED = """
abs acos active alignas alignof all any arguments asm atan atomic attribute auto await bool boolean
bool2 bool3 bool4 break buffer bvec2 bvec3 bvec4 byte case cast catch cbuffer ceil centroid char
class coherent column_major common compile const constexpr continue cross debugger decltype default
delete discard distance do dot double double2 double3 double4 dvec2 dvec3 dvec4 dword else enum eval
exp2 explicit export extends extern external false filter final finally fixed flat float float2
float3 float4 floor fmod for fract friend from function globallycoherent goto groupshared half half2
half3 half4 highp if image1D image2D implements import in inline inout input instanceof int int2
int3 int4 interface invariant isampler2D ivec2 ivec3 ivec4 layout length let lerp line lineadj log
log2 long lowp main mat2 mat3 mat4 math matrix mediump mix mod mutable namespace nan new noinline
noise noperspective normalize null of operator out output package packoffset partition pass patch
pixelfragment point precise precision private protected public readonly reflect refract register
resource restrict return round row_major sample sampler sampler1D sampler2D sampler3D saturate
shared short sign signed sizeof smooth smoothstep snorm static static_assert step string struct
subroutine super superp switch tbuffer technique template texture texture2D this thread_local throw
transpose triangle true try typedef typeid typename typeof uint uint2 uint3 uint4 undefined uniform
union unorm unsigned using uvec2 uvec3 uvec4 var varying vec vec2 vec3 vec4 vector vertexfragment
virtual void volatile while with writeonly yield np numpy
bpy given mathutils sun towards uniforms zenith
"""
# Families of types, macros of C, and what a program calls its parameters within their range.
_FAMILIES = re.compile(
    r"[iu]?(sampler|image|texture|subpassInput)\w*|(RW|Append|Consume)\w+|min\d+\w+"
    r"|([biud]?vec|d?mat|float|half|u?int|bool|double|dword|isnan|isinf)([1-4](x[1-4])?)?"
    r"|[A-Z][A-Z0-9_]+|held_\w+",
)
RESERVED = frozenset(_RESERVED.split()) | frozenset((*keyword.kwlist, *keyword.softkwlist))


def argument_names(names: Iterable[str], functions: Iterable[Function]) -> tuple[str, ...]:
    """Names of arguments in every language, for swept parameters in their order.

    A name such as "haze.optical_depth" is none in a program, "half" is a type in some, and "gamma"
    would hide the angle of that name: what is no name, or taken, is given one that is free.

    Args:
        names: Swept parameters.
        functions: All other names of the program are those of these functions.
    """
    taken = set(RESERVED) | {*BUILT_IN, *VECTORS, "where", "vector", "clamp"}
    for function in functions:
        texts = [function.name, function.result, *function.arguments]
        texts += [text for line in function.body for text in (line.name, line.expression)]
        taken |= set(re.findall(r"[A-Za-z_]\w*", " ".join(texts)))
    found: list[str] = []
    for name in names:
        text = re.sub(r"_+", "_", re.sub(r"\W", "_", name, flags=re.ASCII)).strip("_")
        text = text if re.match(r"[A-Za-z]", text) else f"swept_{text}".rstrip("_")
        text = f"swept_{text}" if _FAMILIES.fullmatch(text) else text
        while text in taken:
            text += "_swept"
        taken.add(text)
        found.append(text)
    return tuple(found)
