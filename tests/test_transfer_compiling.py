"""Programs compiled with options, alone and inside a caller's transformations."""

import jax
import jax.numpy as jnp
import pytest

from skyfit.transfer import compiling


@pytest.fixture
def cube():
    traced = []

    @compiling.compile_quickly
    def cube(x):
        traced.append(1)
        return x**3

    cube.traced = traced
    return cube


def test_it_compiles_once_and_calls_as_the_function_does(cube):
    assert float(cube(jnp.asarray(2.0))) == 8.0
    assert float(cube(jnp.asarray(3.0))) == 27.0
    assert len(cube.traced) == 1
    assert cube.__name__ == "cube"


def test_a_callers_transformations_take_it_for_a_part(cube):
    x = jnp.asarray(2.0)
    assert float(jax.grad(cube)(x)) == 12.0
    assert float(jax.jit(jax.grad(jax.grad(cube)))(x)) == 12.0
    assert float(jax.jit(lambda: cube(jnp.asarray(2.0)))()) == 8.0
    assert jax.vmap(cube)(jnp.arange(3.0)).tolist() == [0.0, 1.0, 8.0]
    assert float(jax.linearize(cube, x)[1](x)) == 24.0


def test_an_xla_without_the_option_compiles_all_the_same(cube, monkeypatch):
    monkeypatch.setattr(compiling, "_OPTIONS", {"xla_has_no_such_option": True})
    compiling._known_options.cache_clear()
    try:
        assert compiling._known_options() is None
        assert float(cube(jnp.asarray(2.0))) == 8.0
    finally:
        compiling._known_options.cache_clear()


def test_a_listener_is_told_of_every_program_but_of_no_second_call(cube):
    told = []
    with compiling.told_of_compiling(lambda: told.append(1)):
        for x in (2.0, 3.0):
            cube(jnp.asarray(x))
        cube(jnp.arange(3.0))
    assert len(told) == 2
    cube(jnp.arange(4.0))
    assert len(told) == 2


def test_what_xla_flags_sets_is_not_set_again(monkeypatch):
    monkeypatch.setenv("XLA_FLAGS", "--xla_backend_optimization_level=0")
    compiling._known_options.cache_clear()
    try:
        assert compiling._known_options() == {"xla_cpu_use_fusion_emitters": False}
    finally:
        compiling._known_options.cache_clear()


def test_this_xla_has_the_option(monkeypatch):
    """An alarm: without it everything works, and compiling takes half as long again."""
    monkeypatch.delenv("XLA_FLAGS", raising=False)
    compiling._known_options.cache_clear()
    assert compiling._known_options() == compiling._OPTIONS
    compiling._known_options.cache_clear()
