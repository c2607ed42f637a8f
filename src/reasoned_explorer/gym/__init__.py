"""The task as a Gymnasium environment, for agents that are trained or written outside of this package.

Importing this room registers ``reasoned_explorer/Outdoor-v0``; so does its name, without an import:

```python
import gymnasium

env = gymnasium.make("reasoned_explorer.gym:reasoned_explorer/Outdoor-v0", world="park:7", goal="Find me a bench")
```

See `reasoned_explorer.gym.environment.OutdoorEnv` for what it observes, what can be done and what is rewarded.
"""

from reasoned_explorer.model.errors import MissingDependencyError

try:
    from gymnasium.envs.registration import register
except ModuleNotFoundError as error:
    raise MissingDependencyError(
        "reasoned_explorer.gym", "gymnasium", "pip install 'reasoned-explorer[gym]'"
    ) from error

#: What the environment is registered under.
OUTDOOR_ID = "reasoned_explorer/Outdoor-v0"

register(id=OUTDOOR_ID, entry_point="reasoned_explorer.gym.environment:OutdoorEnv")
