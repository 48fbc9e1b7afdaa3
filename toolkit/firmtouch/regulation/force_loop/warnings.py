"""What to beware of in a force loop, in words."""

from __future__ import annotations

from collections.abc import Iterator

from firmtouch.regulation.force_loop.analysis import ForceLoop, RealContact


def force_warnings(force: ForceLoop) -> Iterator[str]:
    """Say where the force feedback is more than its signal's path or the contact bears [T8], [T9]."""
    strongest = force.loops[-1]
    if not force.given and strongest.gain >= 1:
        yield (
            f"The largest force-feedback gain is {strongest.gain:.3g}. An undelayed force signal allows any, but one "
            "that comes one sample late is stable only below 1; `force_path` in the file tells what yours allows."
        )
    if not force.stable:
        yield (
            f"The force loop is unstable: G_f has an eigenvalue of {strongest.gain:.4g}, and with this `force_path` it "
            f"must stay below {strongest.bound:.4g} [T8]."
        )
    else:
        for each in force.verdicts:
            if not each.kept:
                unit = " s" if each.name == "delay" else ""
                yield (
                    f"The {each.name} margin of the force loop is {each.least:.4g}{unit}, where {each.asked:.4g}{unit} "
                    f"is asked; G_f = g I keeps all margins up to g = {force.admissible:.4g}."
                )
    if force.contact is not None:
        yield from _contact_warnings(force.contact)


def _contact_warnings(contact: RealContact) -> Iterator[str]:
    poles = contact.poles
    if poles is None:
        yield "The delay is too long beside the contact's own motion: its poles at `contact_stiffness` are not known."
        return
    if not poles.stable:
        least = contact.critical_gain
        since = (
            f"so it is for G_f = g I from g = {least:.3g} on" if least > 0 else "so it is without force feedback too"
        )
        yield (
            f"At the file's `contact_stiffness` the loop is unstable, with a pole at {_short(poles.poles[0])} 1/s; "
            f"{since} [T9]. A softer contact, a faster force path or more damping C along the normal would help."
        )
    if not poles.kept:
        slowest = max(poles.tangent, key=lambda s: s.real)
        yield (
            "At the file's `contact_stiffness` the poles of (38) leave what the design asks for: the slowest of them "
            f"is at {_short(slowest)} 1/s [T9]."
        )


def _short(pole: complex) -> str:
    return f"{pole.real:.4g}" if pole.imag == 0 else f"{pole.real:.4g} ± {abs(pole.imag):.4g}j"
