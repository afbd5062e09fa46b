"""Numba for modules of compiled loops, which take it from here: interrupts are answered, and no outdated code is run.

Machine code is made in one call of at most half a second, in which the compiler calls back into Python. An interrupt in
those callbacks, if every one ends up that came during the call, is dropped by Python, and what was half made then
fails with an error of its own; so is one in the callback of a weak reference, of which compiling ends many. So it is
raised again as soon as the callback has ended. If the compiler takes a
module over, an interrupt just after it left two owners, each of which freed it; one at the very end of compiling left
interrupts handled as while it lasts: there, too, it comes again a little later. What is kept of compiled code:
``kept_code.py``.

An interrupt while compiled loops run came when the arrays that they return are made, for each of which Python was asked
for their class. Of two arrays the second one then ended in ``SystemError``. The class is among the loop's constants
here, so that nobody is asked and the interrupt comes once the loop has returned.

Python code of ctypes reads the functions of a generator of random numbers. An interrupt there ended the process:
Numba goes on with an object that does not exist. Here they are read from what the generator offers to C.

What it frees later it frees in destructors, too, when the collector comes to it, long after compiling. An interrupt
there is dropped as well, so it is raised again.

Of Numba half imported what is left cannot be imported again: an interrupt there, too, comes once all of it is. It
lists what it knows of types when it first compiles. An interrupt there lost the rest of a list, and later loops
ended in ``TypingError``, so lists are made here, in less than half a second, and the interrupt comes after them.
"""

from __future__ import annotations

import _weakrefset
import signal
import sys
import threading
import weakref
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from ratt_opt.running.interrupts import again_later, interrupts_afterwards

with interrupts_afterwards():
    import numba
    from llvmlite import ir
    from llvmlite.binding import executionengine, ffi, linker
    from numba.core import boxing, cgutils, compiler_lock, event, pythonapi, types
    from numba.core.caching import CompileResultCacheImpl
    from numba.core.registry import cpu_target

    from ratt_opt.running.kept_code import SourcesLocator

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType

__all__ = ["numba"]


def _makers(kind: Any) -> Iterator[Any]:
    """What makes the instances of a class, and of all that are derived from it."""
    yield kind.__init__
    for derived in kind.__subclasses__():
        yield from _makers(derived)


DROPPED_IN = {"_raw_object_cache_notify", "_raw_object_cache_getbuffer", "__del__"}
"""Functions called by compiled code or the collector, which drop exceptions."""
CALLED_BACK = {weakref.__file__, _weakrefset.__file__}
"""Files of the callbacks of weak references, of which Python drops exceptions, too: one interrupt in 14 of searches
that compiled was lost there."""
HANDS_OVER = {
    function.__code__
    for function in (
        compiler_lock._CompilerLock.__enter__,
        compiler_lock._CompilerLock.__exit__,
        ffi._LLVMLock.__enter__,
        ffi._LLVMLock.__exit__,
        linker.link_modules,
        executionengine.create_mcjit_compiler,
        executionengine.ExecutionEngine.add_module,
        executionengine.ExecutionEngine.remove_module,
        ffi.ObjectRef.close,
        ffi.OutputString.close,
        *_makers(ffi.ObjectRef),
    )
}
"""Code of the functions that note who owns a thing, a lock or the handling of interrupts only after they have handed it
over, or freed it. A thing half made cannot be freed: its destructor ended in an error, which was shown."""
FREED_BY = ("llvmlite.", "numba.", weakref.__name__, _weakrefset.__name__)
"""Modules of the destructors and callbacks in which the collector frees what was compiled."""


class _Interrupts(event.Listener):
    """Handles interrupts while the main thread compiles, or loads what was compiled; both may nest."""

    def __init__(self) -> None:
        self._depth = 0
        self._before: Any = None

    def on_start(self, event: object) -> None:
        """Handle interrupts from now on, in the place of the handler that raises them otherwise."""
        del event
        if threading.current_thread() is not threading.main_thread():
            return
        if self._depth == 0 and callable(before := signal.getsignal(signal.SIGINT)):
            self._before = before
            signal.signal(signal.SIGINT, self._interrupt)
        self._depth += 1

    def on_end(self, event: object) -> None:
        """Handle them as before."""
        del event
        if threading.current_thread() is not threading.main_thread():
            return
        self._depth -= 1
        if self._depth == 0 and self._before is not None:
            signal.signal(signal.SIGINT, self._before)
            self._before = None

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if _must_wait(frame):
            again_later(number)
        else:
            self._before(number, frame)


def _must_wait(frame: FrameType | None) -> bool:
    """Whether an interrupt in this frame would be dropped, or leave something with two owners."""
    while frame is not None:
        code = frame.f_code
        if code.co_name in DROPPED_IN or code.co_filename in CALLED_BACK or code in HANDS_OVER:
            return True
        frame = frame.f_back
    return False


def _raised_again(hook: Callable[[sys.UnraisableHookArgs], object]) -> Callable[[sys.UnraisableHookArgs], None]:
    """``hook`` of what Python drops, except an interrupt dropped where compiled code is freed: that comes again."""

    def dropped(what: sys.UnraisableHookArgs) -> None:
        module = getattr(what.object, "__module__", None) or ""
        if issubclass(what.exc_type, KeyboardInterrupt) and module.startswith(FREED_BY):
            again_later()
        else:
            hook(what)

    return dropped


def _array_of_constant_class(kind: Any, value: Any, context: Any) -> Any:
    """Code that makes an array for Python, as Numba's own except for its class, which that keeps pickled."""
    api, constants = context.pyapi, context.env_manager
    api.serialize_object, api.unserialize = constants.add_const, constants.read_const
    try:
        return boxing.box_array(kind, value, context)
    finally:
        del api.serialize_object, api.unserialize


def _bit_generator(kind: Any, generator: Any, context: Any) -> Any:
    """Code that takes a source of random bits from Python: its state and functions, as NumPy's ``bitgen_t`` has them.

    Source: ``numpy/random/bitgen.h`` and "C API for random" of NumPy's reference, which fix the struct and the name.
    """
    api, builder = context.pyapi, context.builder
    write: Any = cgutils  # without types
    taken = write.create_struct_proxy(kind)(context.context, builder)
    taken.parent = generator
    is_error = write.alloca_once_value(builder, write.false_bit)
    with ExitStack() as stack:
        capsule = api.object_getattr_string(generator, "capsule")
        with write.early_exit_if_null(builder, stack, capsule):
            builder.store(write.true_bit, is_error)
        name = context.context.insert_const_string(builder.module, "BitGenerator")
        pointer = ir.FunctionType(write.voidptr_t, [api.pyobj, write.voidptr_t])
        fields = builder.call(api._get_function(pointer, "PyCapsule_GetPointer"), [capsule, name])
        api.decref(capsule)  # the generator has it, too
        with write.early_exit_if_null(builder, stack, fields):
            builder.store(write.true_bit, is_error)
        fields = builder.bitcast(fields, write.intp_t.as_pointer())
        for place, field in enumerate(("state", "fnptr_next_uint64", "fnptr_next_uint32", "fnptr_next_double")):
            setattr(taken, field, builder.load(write.gep(builder, fields, place)))
        taken.state_address = taken.state
    native: Any = pythonapi.NativeValue
    return native(taken._getvalue(), is_error=builder.load(is_error))


with interrupts_afterwards():
    cpu_target.typing_context.refresh()
    cpu_target.target_context.refresh()
INTERRUPTS = _Interrupts()
for kind in ("numba:compiler_lock", "numba:llvm_lock"):  # all of compiling; what is freed later
    event.register(kind, INTERRUPTS)  # type: ignore[no-untyped-call]
sys.unraisablehook = _raised_again(sys.unraisablehook)
pythonapi._boxers.functions[types.Array] = _array_of_constant_class
pythonapi._unboxers.functions[types.NumPyRandomBitGeneratorType] = _bit_generator
CompileResultCacheImpl._locator_classes = [SourcesLocator, *SourcesLocator.others]
