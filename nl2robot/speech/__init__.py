"""Speech in and out, on this machine alone.

audio        any recording or live sound -> 16 kHz mono samples; webm: what browsers record
hear/        microphone, open_microphone, recording: samples as they come
             listening: when somebody speaks; streaming: their words while they do
             recogniser: samples and what may be said -> the words, and whether to believe them;
             vosk_decoder: word by word; rescorer: utterances as a whole, and what to believe
             moonshine, whisper: the networks of the rescorer, for English, for German and French;
             search: the texts that one may write; subwords, byte_pairs: what it writes them in;
             expectation: what is likely to be said; log_mel, ct2_file: what Whisper looks at
             answers: what may be answered to a question; replies: what somebody replied
             vocabulary: words that the speech model can never hear, and what to call them
             echo_cancelling: the robot's own voice, taken out; full_duplex: who speaks over it
hotword/     "hey robot" and "stop", always: detector; words, head, judge: its two stages;
             spotting: any other word
digits/      which digit a short sound is: classifier; encoder: Moonshine's part in it
embeddings   what hot words and digits are told by
speak/       voices: text -> sound; sentences: what is spoken at a time; sound_cache: what was
             spoken before; voice_process: where that happens; voice_worker: what runs there (GPL)
             speaking: one text after the other, silent at once; loudspeaker, browser: where it goes
             people: the voices of the simulated people; aloud: a run that is heard
scenes       noise and rooms
"""
