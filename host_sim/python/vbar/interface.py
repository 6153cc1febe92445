

# Beside the messages: runs, campaigns and verifications as tables of pandas, which is imported when one is read.
_READERS = {"run": "run_folder", "start": "run_folder", "Run": "run_folder", "program": "programs", "unit_of": "run_folder",
            "campaign": "campaign_folder", "start_campaign": "campaign_folder", "verification": "campaign_folder"}


def __getattr__(name):
    import importlib
    if name in _READERS:
        return getattr(importlib.import_module(f"vbar.{_READERS[name]}"), name)
    raise AttributeError(f"module vbar has no attribute {name}")
