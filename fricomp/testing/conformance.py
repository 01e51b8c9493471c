"""The conformance suite of adapters: subclass it with one fixture called `rig`, and pytest runs it all.

class TestMyAdapter(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return MyRig()
"""

import pytest

import fricomp.testing.asserts  # noqa: F401
from fricomp.testing.conformance_cycle import CycleConformance
from fricomp.testing.conformance_exchange import ExchangeConformance
from fricomp.testing.conformance_holding import HoldingConformance
from fricomp.testing.conformance_link_failure import LinkFailureConformance
from fricomp.testing.conformance_preparation import PreparationConformance
from fricomp.testing.conformance_sensors import SensorConformance
from fricomp.testing.conformance_stopping import StoppingConformance
from fricomp.testing.rig import AdapterRig


class AdapterConformance(
    PreparationConformance,
    HoldingConformance,
    ExchangeConformance,
    LinkFailureConformance,
    SensorConformance,
    StoppingConformance,
    CycleConformance,
):
    """Every promise of an adapter as a test."""

    @pytest.fixture
    def rig(self) -> AdapterRig:
        """The rig under test; to be overridden."""
        raise NotImplementedError("give this class a fixture `rig` that returns an AdapterRig")

    @pytest.fixture(autouse=True)
    def _skip_what_the_protocol_rules_out(self, rig: AdapterRig, request: pytest.FixtureRequest) -> None:
        name = getattr(request.node, "originalname", request.node.name)
        if name in rig.exempt:
            pytest.skip(f"ruled out by the protocol: {rig.exempt[name]}")
