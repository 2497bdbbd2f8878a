"""A local language model: its weights, its graph, its tokens, and a process of its own to run in.

    gguf file --(installation)--> graph + weights + tokens --(first use)--> LanguageModel

`grammar.planning.model` knows what is asked of it; nothing here knows about robots.
"""
