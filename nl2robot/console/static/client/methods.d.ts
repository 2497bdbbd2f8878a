/**
 * What can be called on the wire, made by `make client` from what `rpc.discover` answers; not to be
 * edited. A robot has those of the methods of `robot` that it can do.
 */

export interface Methods {
  robot: {
    /** Speak a text aloud; returns when it has been spoken. */
    say: {
      params: {
        /** what to say */
        text: string;
        /** such as "de"; the set language if left out */
        language?: string | null;
      };
      result: null;
    };
    /** Listen to whoever is there and return the words heard. */
    listen: {
      params: {
        /** what to say first */
        prompt?: string | null;
        /** seconds to wait for somebody to speak */
        timeout?: number;
      };
      result: string;
    };
    /**
     * Ask a question and return the answer: one of the options exactly, or the words heard.
     */
    ask: {
      params: {
        /** what to ask */
        question: string;
        /** the answers that count, up to 20 */
        options?: string[] | null;
        /** whom to ask; whoever is here if left out */
        person?: string | null;
      };
      result: string;
    };
    /** Answer a question from the predefined ones; listens for it if none is given. */
    answer: {
      params: {
        /** the question; heard from whoever is here */
        question?: string | null;
      };
      result: string;
    };
    /** Set how loud the robot speaks. */
    set_volume: {
      params: {
        /** 0 is silent, 100 the loudest */
        percent: number;
      };
      result: null;
    };
    /** Set the language the robot speaks and hears. */
    set_language: {
      params: {
        /** "en", "de" or "fr" */
        code: string;
      };
      result: null;
    };
    /** Drive to a place, a point of the map, or a location remembered before. */
    goto: {
      params:
        | {
            /** a place's name, or a Location */
            place:
              | string
              | {
                  x: number;
                  y: number;
                  theta?: number;
                  place?: string | null;
                };
          }
        | {
            /** metres along the map's x axis */
            x: number;
            /** metres along the map's y axis */
            y: number;
            /** degrees to face at the end; any if left out */
            theta?: number | null;
          };
      result: null;
    };
    /** Drive straight ahead (or back, if negative). */
    move: {
      params: {
        /** how far */
        metres: number;
      };
      result: null;
    };
    /** Turn on the spot. */
    turn: {
      params: {
        /** how far; left is + */
        degrees: number;
      };
      result: null;
    };
    /** Drive as with a joystick for a moment. */
    drive: {
      params: {
        /** metres per second ahead */
        linear: number;
        /** degrees per second; left is + */
        angular: number;
        /** for how long */
        seconds: number;
      };
      result: null;
    };
    /** Stop everything at once. */
    stop: {
      params: {
        /** in whose name, for those who look on */
        who?: string;
      };
      result: null;
    };
    /** Wait for a while. */
    wait: {
      params: {
        /** how long */
        seconds: number;
      };
      result: null;
    };
    /**
     * Wait until the clock next shows a time: today, or tomorrow if that is over today.
     */
    wait_until: {
      params: {
        /** local time, "06:00" or "14:30" */
        time: string;
        /** on the next such day, "Monday"; any day */
        weekday?:
          | ('Monday' | 'Tuesday' | 'Wednesday' | 'Thursday' | 'Friday' | 'Saturday' | 'Sunday')
          | null;
        /** on that day, "2026-12-24"; the next one if left out */
        date?: string | null;
      };
      result: null;
    };
    /** Drive back to the charging station. */
    dock: {
      params: Record<string, never>;
      result: null;
    };
    /** Tell where the robot is. */
    location: {
      params: Record<string, never>;
      result: {
        x: number;
        y: number;
        theta?: number;
        place?: string | null;
      };
    };
    /** Tell the robot where it is, when it is wrong about it. */
    localize: {
      params:
        | {
            /** a place's name, or a Location */
            place:
              | string
              | {
                  x: number;
                  y: number;
                  theta?: number;
                  place?: string | null;
                };
          }
        | {
            /** metres along the map's x axis */
            x: number;
            /** metres along the map's y axis */
            y: number;
            /** degrees it faces */
            theta: number;
          };
      result: null;
    };
    /** List the named places. */
    places: {
      params: {
        /** only those of a kind: "office", "ward", "lab" */
        kind?: string | null;
      };
      /**
       * @minItems 0
       * @maxItems 1000
       */
      result: string[];
    };
    /** Show an emotion. */
    emotion: {
      params: {
        /** "neutral", "happy", "sad", "confused", "angry", ... */
        name: string;
      };
      result: null;
    };
    /** Make a gesture. */
    gesture: {
      params: {
        /** "wave", "nod", "bow", "point", ... */
        name: string;
      };
      result: null;
    };
    /** Move one joint to an angle and hold it there. */
    joint: {
      params: {
        /** "head_yaw", "left_shoulder", ... */
        name: string;
        /** the angle */
        degrees: number;
      };
      result: null;
    };
    /** Read the last lines of the robot's debug log. */
    log: {
      params: {
        /** how many */
        lines?: number;
      };
      result: string[];
    };
    /** Start a video call with a contact. */
    call: {
      params: {
        /** whom to call */
        contact: string;
      };
      result: null;
    };
    /** End the video call. */
    hang_up: {
      params: Record<string, never>;
      result: null;
    };
    /** Scan a bar code or QR code held before the robot and return what it says. */
    scan: {
      params: {
        /** what to say first */
        prompt?: string | null;
        /** seconds to wait for a code */
        timeout?: number;
      };
      result: string;
    };
    /** Show a text, a page of HTML or a web page on the screen. */
    show: {
      params: {
        /** plain text in large letters */
        text?: string | null;
        /** a page of HTML */
        html?: string | null;
        /** the address of a web page */
        url?: string | null;
      };
      result: null;
    };
    /** Click on an element of the page on the screen. */
    click: {
      params: {
        /** a CSS selector */
        selector: string;
      };
      result: null;
    };
    /** Type into a field of the page on the screen. */
    type_text: {
      params: {
        /** a CSS selector */
        selector: string;
        /** what to type */
        text: string;
      };
      result: null;
    };
    /** Show buttons on the touchscreen and return the one that is touched. */
    touch: {
      params: {
        /**
         * the buttons, up to 20
         *
         * @minItems 1
         * @maxItems 20
         */
        options: string[];
        /** what to say first */
        prompt?: string | null;
      };
      result: string;
    };
    /** Read the text of an element of the page on the screen. */
    read_text: {
      params: {
        /** a CSS selector */
        selector: string;
      };
      result: string;
    };
    /** Tell whether the robot sees such a thing or person where it is. */
    sees: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
      };
      result: boolean;
    };
    /** Count such things or people where the robot is. */
    count: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
      };
      result: number;
    };
    /** List the objects the robot sees where it is. */
    objects: {
      params: Record<string, never>;
      /**
       * @minItems 0
       * @maxItems 1000
       */
      result: string[];
    };
    /** List the people the robot sees where it is. */
    people: {
      params: Record<string, never>;
      /**
       * @minItems 0
       * @maxItems 1000
       */
      result: string[];
    };
    /** Describe such a thing or person in one sentence. */
    describe: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
      };
      result: string;
    };
    /**
     * Look for such a thing or person, here and then from place to place, and stand by it.
     */
    find: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
        /** look only there */
        place?: string | null;
      };
      result: boolean;
    };
    /**
     * Wait until such a thing or person is there that was not already met by waiting here.
     */
    wait_for: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
        /** seconds; for ever if left out */
        timeout?: number | null;
      };
      result: boolean;
    };
    /** Take a thing that is here. */
    grab: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
      };
      result: null;
    };
    /** Put a thing that is held down here, on or in a piece of furniture of this place. */
    put: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
        /** furniture of this place; just here if left out */
        where?: string | null;
      };
      result: null;
    };
    /** Hand a thing that is held to a person who is here. */
    give: {
      params: {
        /** a noun phrase: "stapler", "red cup", "person waving", "biggest box" */
        thing: string;
        /** a name or a kind; whoever is here if left out */
        person?: string | null;
      };
      result: null;
    };
    /** Go after a person until they reach a place, stand still for a while, or a stop. */
    follow: {
      params: {
        /** a name or a kind: "Alice", "nurse", "person" */
        person: string;
        /** the place where following ends */
        to?: string | null;
      };
      result: null;
    };
    /** Lead a person to a place at their pace, waiting for them. */
    guide: {
      params: {
        /** a name or a kind: "Alice", "nurse", "person" */
        person: string;
        /** where to */
        place:
          | string
          | {
              x: number;
              y: number;
              theta?: number;
              place?: string | null;
            };
      };
      result: null;
    };
    /** Tell the time, the weekday, the date and the time zone. */
    clock: {
      params: Record<string, never>;
      result: {
        time: string;
        weekday: string;
        date: string;
        zone?: string;
      };
    };
    /** Tell the battery's charge in percent. */
    battery: {
      params: Record<string, never>;
      result: number;
    };
    /** Use a skill of this robot's own, listed in its capabilities. */
    do: {
      params: {
        /** such as "sit" for a robotic dog */
        skill: string;
        [k: string]: unknown;
      };
      result: unknown;
    };
    /** Tell what this robot can do. */
    capabilities: {
      params: Record<string, never>;
      /** What a robot can do; sent to every client that asks with `robot.capabilities`. */
      result: {
        name: string;
        kind: string;
        methods: string[];
        languages?: string[];
        emotions?: string[];
        gestures?: string[];
        joints?: {
          /**
           * @minItems 2
           * @maxItems 2
           */
          [k: string]: never[];
        };
        skills?: {
          [k: string]: string;
        };
        contacts?: string[];
        hands?: number;
        units?: string;
        stand_ins?: {
          [k: string]: string;
        };
        stop_within?: number;
        limits?: {
          [k: string]: number;
        };
      };
    };
  };
  rpc: {
    /** Return this document. */
    discover: {
      params: Record<string, never>;
      result: {
        [k: string]: unknown;
      };
    };
    /** Stop the call in flight that has this id; true if there was one. */
    cancel: {
      params: {
        id: unknown;
      };
      result: boolean;
    };
    /**
     * Receive these events from now on ("*" is every event). Of "link" and "stop_not_confirmed" the last one is sent at once, if it still holds.
     */
    subscribe: {
      params: {
        events: string[];
      };
      result: string[];
    };
    /** Receive these events no more. */
    unsubscribe: {
      params: {
        events: string[];
      };
      result: string[];
    };
  };
  voice: {
    /**
     * Listen to a client's microphone; returns its number. With interrupts, whoever speaks there makes the robot silent: for one that does not hear the robot itself. With held, all until voice.close is one command, and stop is told at once.
     */
    open: {
      params: {
        rate: number;
        channels?: number;
        language?: string;
        talk?: string | null;
        interrupts?: boolean;
        held?: boolean;
      };
      result: number;
    };
    /** Load what hears a language: somebody is about to speak. */
    ready: {
      params: {
        language?: string;
      };
      result: null;
    };
    /**
     * Hand over a block of sound (base64 of 16-bit samples); returns what happened: began, partial, heard with its program (where that takes a while: thinking, and in a later answer heard or given up), too long, and of a held microphone stop. To call robot.stop then is the client's.
     */
    push: {
      params: {
        microphone: number;
        sound: string;
      };
      /**
       * Items: What there was to tell of a microphone; `translation` is what was heard as a program.
       */
      result: {
        doubtful?: boolean;
        perhaps?: string | null;
        stop?: boolean;
        text?: string;
        /** What became of an utterance; `to_json` gives the object of `translate --json`. */
        translation?: {
          utterance: string;
          status: 'clarify' | 'ok' | 'rejected';
          program: string | null;
          plan: {
            [k: string]: unknown;
          } | null;
          source: string | null;
          confidence: number;
          explanation: string;
          message: string | null;
          suggestions: string[];
          ms: number;
          unused?: string[];
          own?: string[];
          request?: {
            kind:
              | 'appointments'
              | 'cancel'
              | 'change'
              | 'counted'
              | 'doing'
              | 'done'
              | 'explain'
              | 'forget'
              | 'found'
              | 'happened'
              | 'help'
              | 'how many said'
              | 'learn'
              | 'list'
              | 'pace'
              | 'planned'
              | 'rename'
              | 'said'
              | 'schedule'
              | 'skip'
              | 'undo'
              | 'unschedule'
              | 'who said'
              | 'why';
            name?: string;
            new?: string;
            sentence?: string;
            part?: string;
            when?: {
              times?: string[];
              bare?: string[];
              half?: ('am' | 'night' | 'pm') | null;
              weekdays?: number[];
              days_ahead?: number | null;
              date?: string | null;
              minutes?: number | null;
              repeats?: boolean;
              count?: number | null;
              since?: string | null;
              until?: string | null;
            } | null;
            happening?: {
              what: 'battery' | 'heard' | 'place' | 'pressed' | 'scanned' | 'seen';
              text?: string;
              thing?: string;
              place?: string;
              below?: number;
              rate?: number | null;
              once?: boolean;
              named?: boolean;
            } | null;
          } | null;
          schedule?: {
            rhythm?: {
              begins: string;
              zone: string;
              rule?: string | null;
            } | null;
            trigger?: {
              what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
              text?: string;
              thing?: string;
              place?: string;
              topic?: string;
              below?: number;
              every?: number;
            } | null;
            when: string;
            sentence: string;
            program: string;
            plan: {
              [k: string]: unknown;
            } | null;
            source: string | null;
            confidence: number;
            explanation: string;
            unused?: string[];
            own?: string[];
          } | null;
        };
        what:
          'began' | 'given up' | 'heard' | 'nothing' | 'partial' | 'stop' | 'thinking' | 'too long';
      }[];
    };
    /** End listening; returns what was still to be told, once it is thought about. */
    close: {
      params: {
        microphone: number;
      };
      /**
       * Items: What there was to tell of a microphone; `translation` is what was heard as a program.
       */
      result: {
        doubtful?: boolean;
        perhaps?: string | null;
        stop?: boolean;
        text?: string;
        /** What became of an utterance; `to_json` gives the object of `translate --json`. */
        translation?: {
          utterance: string;
          status: 'clarify' | 'ok' | 'rejected';
          program: string | null;
          plan: {
            [k: string]: unknown;
          } | null;
          source: string | null;
          confidence: number;
          explanation: string;
          message: string | null;
          suggestions: string[];
          ms: number;
          unused?: string[];
          own?: string[];
          request?: {
            kind:
              | 'appointments'
              | 'cancel'
              | 'change'
              | 'counted'
              | 'doing'
              | 'done'
              | 'explain'
              | 'forget'
              | 'found'
              | 'happened'
              | 'help'
              | 'how many said'
              | 'learn'
              | 'list'
              | 'pace'
              | 'planned'
              | 'rename'
              | 'said'
              | 'schedule'
              | 'skip'
              | 'undo'
              | 'unschedule'
              | 'who said'
              | 'why';
            name?: string;
            new?: string;
            sentence?: string;
            part?: string;
            when?: {
              times?: string[];
              bare?: string[];
              half?: ('am' | 'night' | 'pm') | null;
              weekdays?: number[];
              days_ahead?: number | null;
              date?: string | null;
              minutes?: number | null;
              repeats?: boolean;
              count?: number | null;
              since?: string | null;
              until?: string | null;
            } | null;
            happening?: {
              what: 'battery' | 'heard' | 'place' | 'pressed' | 'scanned' | 'seen';
              text?: string;
              thing?: string;
              place?: string;
              below?: number;
              rate?: number | null;
              once?: boolean;
              named?: boolean;
            } | null;
          } | null;
          schedule?: {
            rhythm?: {
              begins: string;
              zone: string;
              rule?: string | null;
            } | null;
            trigger?: {
              what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
              text?: string;
              thing?: string;
              place?: string;
              topic?: string;
              below?: number;
              every?: number;
            } | null;
            when: string;
            sentence: string;
            program: string;
            plan: {
              [k: string]: unknown;
            } | null;
            source: string | null;
            confidence: number;
            explanation: string;
            unused?: string[];
            own?: string[];
          } | null;
        };
        what:
          'began' | 'given up' | 'heard' | 'nothing' | 'partial' | 'stop' | 'thinking' | 'too long';
      }[];
    };
    /** Listen for the hot word at a client's microphone; returns a number. */
    attend: {
      params: {
        rate: number;
        language?: string;
      };
      result: number;
    };
    /**
     * Hand over a block of sound (base64 of 16-bit samples); returns what was heard in it: what (hotword | stop), and the time in seconds of sound. To call robot.stop is the client's.
     */
    notice: {
      params: {
        attention: number;
        sound: string;
      };
      /** Items: A word that was heard; `time` is in seconds of sound. */
      result: {
        time: number;
        what: 'hotword' | 'stop';
      }[];
    };
    /** Listen for the hot word no more. */
    ignore: {
      params: {
        attention: number;
      };
      result: null;
    };
  };
  program: {
    /**
     * Turn words into a program; moves nothing. A language model may take seconds: events of the kind translation tell how far it is, and the call can be cancelled.
     */
    translate: {
      params: {
        utterance: string;
        language?: string;
        planner?: 'auto' | 'grammar' | 'model';
        talk?: string | null;
      };
      /** What became of an utterance; `to_json` gives the object of `translate --json`. */
      result: {
        utterance: string;
        status: 'clarify' | 'ok' | 'rejected';
        program: string | null;
        plan: {
          [k: string]: unknown;
        } | null;
        source: string | null;
        confidence: number;
        explanation: string;
        message: string | null;
        suggestions: string[];
        ms: number;
        unused?: string[];
        own?: string[];
        request?: {
          kind:
            | 'appointments'
            | 'cancel'
            | 'change'
            | 'counted'
            | 'doing'
            | 'done'
            | 'explain'
            | 'forget'
            | 'found'
            | 'happened'
            | 'help'
            | 'how many said'
            | 'learn'
            | 'list'
            | 'pace'
            | 'planned'
            | 'rename'
            | 'said'
            | 'schedule'
            | 'skip'
            | 'undo'
            | 'unschedule'
            | 'who said'
            | 'why';
          name?: string;
          new?: string;
          sentence?: string;
          part?: string;
          when?: {
            times?: string[];
            bare?: string[];
            half?: ('am' | 'night' | 'pm') | null;
            weekdays?: number[];
            days_ahead?: number | null;
            date?: string | null;
            minutes?: number | null;
            repeats?: boolean;
            count?: number | null;
            since?: string | null;
            until?: string | null;
          } | null;
          happening?: {
            what: 'battery' | 'heard' | 'place' | 'pressed' | 'scanned' | 'seen';
            text?: string;
            thing?: string;
            place?: string;
            below?: number;
            rate?: number | null;
            once?: boolean;
            named?: boolean;
          } | null;
        } | null;
        schedule?: {
          rhythm?: {
            begins: string;
            zone: string;
            rule?: string | null;
          } | null;
          trigger?: {
            what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
            text?: string;
            thing?: string;
            place?: string;
            topic?: string;
            below?: number;
            every?: number;
          } | null;
          when: string;
          sentence: string;
          program: string;
          plan: {
            [k: string]: unknown;
          } | null;
          source: string | null;
          confidence: number;
          explanation: string;
          unused?: string[];
          own?: string[];
        } | null;
      };
    };
    /** List what can be said here, by topic. */
    phrases: {
      params: {
        language?: string;
      };
      result: {
        [k: string]: string[];
      };
    };
    /**
     * Review a program: types, what this robot lacks, a dry run; moves nothing. With `continues`, of what is left of it after that run; with `at` (2026-12-24T06:00), as if it began then.
     */
    check: {
      params: {
        program: string;
        language?: string;
        continues?: number | null;
        at?: string;
      };
      /** What a person should know before approving a program. */
      result: {
        program: string;
        sha256: string;
        /**
         * Items: Something wrong ("error": the program will not be run) or doubtful ("warning").
         */
        findings: {
          line: number;
          column: number;
          severity: 'error' | 'warning';
          code: string;
          message: string;
        }[];
        /** Items: A line of the program in plain words. */
        reading: {
          line: number;
          depth: number;
          text: string;
        }[];
        dry_run: {
          status: 'done' | 'failed' | 'limit' | 'stopped' | 'unfinished';
          message: string | null;
          line: number | null;
          seconds: number;
          metres: number;
          says: string[];
          asks: string[];
          holds: string[];
          shows: string[];
          places: string[];
          path: never[][];
          calls: number;
          /**
           * Items: Something that would happen: a place reached, words spoken, asked or shown, a thing moved.
           */
          course?: {
            kind: 'asked' | 'gave' | 'put' | 'said' | 'showed' | 'took' | 'was at';
            what: string;
          }[];
          closed?: string[];
          error?: string | null;
          broke_off?: ('calls' | 'computing' | 'machine' | 'time') | null;
          goes_on?: boolean;
        } | null;
        /** Items: Something to think about, and where it is in the program. */
        risks?: {
          line: number;
          kind: 'endless' | 'leaves' | 'long' | 'person' | 'speed' | 'unproven' | 'volume' | 'zone';
          text: string;
        }[];
      };
    };
    /**
     * Tell what is done and what is left of a run that was broken off, the last one if none is named; null if nothing is. It goes on as any program: approved, with `continues`.
     */
    unfinished: {
      params: {
        run?: number;
        language?: string;
      };
      result: {
        again: {
          method: string;
          arguments: {
            [k: string]: unknown;
          };
          line: number;
          result?: {
            [k: string]: unknown;
          };
          error?: string | null;
          left?: {
            [k: string]: unknown;
          } | null;
        } | null;
        /** Items: A robot call that came back, as the program made it. */
        done: {
          method: string;
          arguments: {
            [k: string]: unknown;
          };
          line: number;
          result?: {
            [k: string]: unknown;
          };
          error?: string | null;
          left?: {
            [k: string]: unknown;
          } | null;
        }[];
        line: number;
        program: string;
        run: number;
        sha256: string;
        stood: {
          [k: string]: number;
        } | null;
        told: string[];
        utterance: string | null;
      } | null;
    };
    /** Tell that a program lies before somebody here who decides on it, or no longer. */
    reviewing: {
      params: {
        lies: boolean;
      };
      result: null;
    };
    /**
     * Approve exactly the program with this SHA-256 for one run, within ten minutes and as long as the connection lasts. With `continues`, the number of a run that was broken off, what was done there is not done again. Where it was changed by hand, `proposed` is the program from before; the log keeps both, and who did. One that does not come to its end in the dry run, which is made now unless it was lately, is refused unless somebody `insists`.
     */
    approve: {
      params: {
        program: string;
        sha256: string;
        by: string;
        utterance?: string | null;
        heard?: string | null;
        language?: string | null;
        plan?: string | null;
        continues?: number | null;
        proposed?: string | null;
        changed_by?: string | null;
        insists?: boolean;
      };
      /** Somebody's word that exactly this program may run once. */
      result: {
        id: string;
        program: string;
        sha256: string;
        by: string;
        at: number;
        utterance?: string | null;
        heard?: string | null;
        language?: string | null;
        plan?: string | null;
        continues?: number | null;
        proposed?: string | null;
        changed_by?: string | null;
      };
    };
    /** Start an approved program; returns the run's number at once. */
    run: {
      params: {
        approval: string;
      };
      result: number;
    };
    /** Wait until a run is over and tell how it ended. */
    wait: {
      params: {
        run: number;
        timeout?: number;
      };
      /** How a run stands; what `program.state` and `program.wait` answer. */
      result: {
        run: number;
        state: 'done' | 'failed' | 'limit' | 'paused' | 'pausing' | 'running' | 'stopped';
        line: number | null;
        message: string | null;
        error: string | null;
        program: string;
        sha256: string;
        calls: number;
        robot_lost_since?: number | null;
      };
    };
    /**
     * Tell what came of a run, in sentences for whoever asked for it; each says whether the robot has spoken it there.
     */
    answer: {
      params: {
        run: number;
        language?: string;
      };
      /** Items: A sentence of an answer. */
      result: {
        text: string;
        spoken?: boolean;
      }[];
    };
    /** Tell how the present or last run stands. */
    state: {
      params: Record<string, never>;
      result: {
        run: number;
        state: 'done' | 'failed' | 'limit' | 'paused' | 'pausing' | 'running' | 'stopped';
        line: number | null;
        message: string | null;
        error: string | null;
        program: string;
        sha256: string;
        calls: number;
        robot_lost_since?: number | null;
      } | null;
    };
    /** Halt the robot and the program: pausing, and paused when it has come to rest. */
    pause: {
      params: Record<string, never>;
      /** How a run stands; what `program.state` and `program.wait` answer. */
      result: {
        run: number;
        state: 'done' | 'failed' | 'limit' | 'paused' | 'pausing' | 'running' | 'stopped';
        line: number | null;
        message: string | null;
        error: string | null;
        program: string;
        sha256: string;
        calls: number;
        robot_lost_since?: number | null;
      };
    };
    /** Do one robot call, then hold again. */
    step: {
      params: Record<string, never>;
      /** How a run stands; what `program.state` and `program.wait` answer. */
      result: {
        run: number;
        state: 'done' | 'failed' | 'limit' | 'paused' | 'pausing' | 'running' | 'stopped';
        line: number | null;
        message: string | null;
        error: string | null;
        program: string;
        sha256: string;
        calls: number;
        robot_lost_since?: number | null;
      };
    };
    /** Go on after a pause; a movement goes on to its goal. */
    resume: {
      params: Record<string, never>;
      /** How a run stands; what `program.state` and `program.wait` answer. */
      result: {
        run: number;
        state: 'done' | 'failed' | 'limit' | 'paused' | 'pausing' | 'running' | 'stopped';
        line: number | null;
        message: string | null;
        error: string | null;
        program: string;
        sha256: string;
        calls: number;
        robot_lost_since?: number | null;
      };
    };
    /** Stop the program; `robot.stop` stops the robot as well. */
    stop: {
      params: Record<string, never>;
      result: null;
    };
    /** List the newest runs of the log. */
    list: {
      params: {
        last?: number;
      };
      /** Items: A row of `runs`; see the schema above for what the fields mean. */
      result: {
        id: number;
        started: number;
        finished: number | null;
        heard: string | null;
        utterance: string | null;
        language: string | null;
        plan: string | null;
        program: string;
        sha256: string;
        approved_by: string;
        approved_at: number;
        world: string | null;
        seed: number | null;
        robot: string | null;
        status: string | null;
        message: string | null;
        picture: string | null;
        start: string | null;
        process: number | null;
        continues?: number | null;
        proposed?: string | null;
        changed_by?: string | null;
        stood?: string | null;
      }[];
    };
  };
  sentence: {
    /**
     * Tell a sentence of an error in another language; one that is not the robot's own software's as it is.
     */
    told: {
      params: {
        sentence: string;
        language: string;
      };
      result: string;
    };
  };
  station: {
    /** Tell how the robot and its program stand, as the event `state` does. */
    state: {
      params: Record<string, never>;
      /** The fields of a `State` that others are told. */
      result: {
        because: string | null;
        charging: boolean;
        driven_by: string | null;
        line: number | null;
        lost_since: number | null;
        run: number | null;
        sequence: number;
        since: number;
        state:
          | 'charging'
          | 'idle'
          | 'lost'
          | 'paused'
          | 'pausing'
          | 'reviewing'
          | 'running'
          | 'stopped'
          | 'stopping';
        unconfirmed: boolean;
      };
    };
  };
  schedule: {
    /**
     * List the appointments of this robot: approved programs with the times at which they are done, when they come next, and which of those were called off.
     */
    list: {
      params: {
        language?: string;
      };
      /** Items: An appointment as it is shown. */
      result: {
        /**
         * An approved program with a time, a rhythm or an event at which it is done. Times are seconds
         *     since the epoch.
         */
        appointment: {
          id: number;
          program: string;
          sha256: string;
          sentence: string;
          plan: string | null;
          language: string;
          rhythm: {
            begins: string;
            zone: string;
            rule?: string | null;
          } | null;
          trigger: {
            what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
            text?: string;
            thing?: string;
            place?: string;
            topic?: string;
            below?: number;
            every?: number;
          } | null;
          robot: string;
          fleet?: string | null;
          approved_by: string;
          approved_at: number;
          approved_until: number;
          reviewed: string;
          insists: boolean;
          priority: number;
          makes_up: number;
          paused: boolean;
          asked: ('changed' | 'ended' | 'moved') | null;
          added: number;
          removed: number | null;
          looked: number;
        };
        when: string;
        next: number[];
        due: number | null;
        off: number[];
        state: string;
        last: number | null;
        came: number;
      }[];
    };
    /**
     * Approve exactly the program with this SHA-256 for a rhythm, or for a trigger, `until` then (seconds since the epoch; 30 days if it is not said). `rhythm`: `begins`, a local time as 2026-11-30T08:00, `zone` as Europe/Zurich (the server's if it is left out) and a `rule` of RFC 5545, or none for once. Of those that wait the one with the highest `priority` begins first. What was missed while the server was not running is made up for within `makes_up` minutes. Before each time it is reviewed again; if that finds something new, it waits for a new approval. With `fleet` any robot of the fleet may do it: this one keeps it, and has it handed out at its time.
     */
    add: {
      params: {
        program: string;
        sha256: string;
        by: string;
        sentence: string;
        language?: string;
        rhythm?: {
          begins: string;
          zone?: string;
          rule?: string | null;
        } | null;
        trigger?: {
          what: 'battery' | 'place' | 'seen' | 'heard' | 'scanned' | 'pressed' | 'message';
          text?: string;
          thing?: string;
          place?: string;
          topic?: string;
          below?: number;
          every?: number;
        } | null;
        plan?: string | null;
        priority?: number;
        makes_up?: number;
        until?: number | null;
        insists?: boolean;
        fleet?: boolean;
      };
      /**
       * An approved program with a time, a rhythm or an event at which it is done. Times are seconds
       *     since the epoch.
       */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        plan: string | null;
        language: string;
        rhythm: {
          begins: string;
          zone: string;
          rule?: string | null;
        } | null;
        trigger: {
          what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
          text?: string;
          thing?: string;
          place?: string;
          topic?: string;
          below?: number;
          every?: number;
        } | null;
        robot: string;
        fleet?: string | null;
        approved_by: string;
        approved_at: number;
        approved_until: number;
        reviewed: string;
        insists: boolean;
        priority: number;
        makes_up: number;
        paused: boolean;
        asked: ('changed' | 'ended' | 'moved') | null;
        added: number;
        removed: number | null;
        looked: number;
      };
    };
    /**
     * Approve an appointment anew, as its program is reviewed now: one whose approval has ended, or whose review came out another way.
     */
    approve: {
      params: {
        id: number;
        sha256: string;
        by: string;
        until?: number | null;
        insists?: boolean;
      };
      /**
       * An approved program with a time, a rhythm or an event at which it is done. Times are seconds
       *     since the epoch.
       */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        plan: string | null;
        language: string;
        rhythm: {
          begins: string;
          zone: string;
          rule?: string | null;
        } | null;
        trigger: {
          what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
          text?: string;
          thing?: string;
          place?: string;
          topic?: string;
          below?: number;
          every?: number;
        } | null;
        robot: string;
        fleet?: string | null;
        approved_by: string;
        approved_at: number;
        approved_until: number;
        reviewed: string;
        insists: boolean;
        priority: number;
        makes_up: number;
        paused: boolean;
        asked: ('changed' | 'ended' | 'moved') | null;
        added: number;
        removed: number | null;
        looked: number;
      };
    };
    /** Have an appointment skipped until it is resumed. */
    pause: {
      params: {
        id: number;
      };
      /**
       * An approved program with a time, a rhythm or an event at which it is done. Times are seconds
       *     since the epoch.
       */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        plan: string | null;
        language: string;
        rhythm: {
          begins: string;
          zone: string;
          rule?: string | null;
        } | null;
        trigger: {
          what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
          text?: string;
          thing?: string;
          place?: string;
          topic?: string;
          below?: number;
          every?: number;
        } | null;
        robot: string;
        fleet?: string | null;
        approved_by: string;
        approved_at: number;
        approved_until: number;
        reviewed: string;
        insists: boolean;
        priority: number;
        makes_up: number;
        paused: boolean;
        asked: ('changed' | 'ended' | 'moved') | null;
        added: number;
        removed: number | null;
        looked: number;
      };
    };
    /** Have a paused appointment done again from its next time on. */
    resume: {
      params: {
        id: number;
      };
      /**
       * An approved program with a time, a rhythm or an event at which it is done. Times are seconds
       *     since the epoch.
       */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        plan: string | null;
        language: string;
        rhythm: {
          begins: string;
          zone: string;
          rule?: string | null;
        } | null;
        trigger: {
          what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
          text?: string;
          thing?: string;
          place?: string;
          topic?: string;
          below?: number;
          every?: number;
        } | null;
        robot: string;
        fleet?: string | null;
        approved_by: string;
        approved_at: number;
        approved_until: number;
        reviewed: string;
        insists: boolean;
        priority: number;
        makes_up: number;
        paused: boolean;
        asked: ('changed' | 'ended' | 'moved') | null;
        added: number;
        removed: number | null;
        looked: number;
      };
    };
    /** Remove an appointment; what was done is still told. A run that goes on goes on. */
    remove: {
      params: {
        id: number;
      };
      result: null;
    };
    /**
     * Call off the next time of an appointment, or all of a day (`date`); with `back`, have them done after all. Returns the times, in seconds since the epoch.
     */
    skip: {
      params: {
        id: number;
        date?: string;
        back?: boolean;
      };
      result: number[];
    };
    /** List the buttons that the robot's face shows: each begins an appointment. */
    buttons: {
      params: Record<string, never>;
      result: string[];
    };
    /**
     * Somebody presses one of `schedule.buttons`. Tells whether that counts: not if it was pressed lately.
     */
    press: {
      params: {
        button: string;
      };
      result: boolean;
    };
    /**
     * Tell how an event that shall begin a program is kept: its place by the name that it has in this house, and what it is in words. Refuses what this robot would never notice. Nothing is planned.
     */
    event: {
      params: {
        trigger: {
          what: 'battery' | 'place' | 'seen' | 'heard' | 'scanned' | 'pressed' | 'message';
          text?: string;
          thing?: string;
          place?: string;
          topic?: string;
          below?: number;
          every?: number;
        };
        language?: string;
      };
      /** An event that may begin a program. */
      result: {
        /**
         * What begins an appointment instead of the clock. `checked` says whether it makes sense.
         */
        trigger: {
          what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
          text?: string;
          thing?: string;
          place?: string;
          topic?: string;
          below?: number;
          every?: number;
        };
        when: string;
      };
    };
    /**
     * List the latest times that came, of an appointment or all, and what became of each; the newest first. Times to come that were called off are among them.
     */
    history: {
      params: {
        id?: number;
        last?: number;
        language?: string;
      };
      /** Items: A time that came, with what became of it in words. */
      result: {
        /** A time at which an appointment was due. */
        occurrence: {
          id: number;
          appointment: number;
          due: number;
          state: 'asked' | 'claimed' | 'done' | 'due' | 'failed' | 'missed' | 'running' | 'skipped';
          run: number | null;
          note: string | null;
          process: number | null;
          began: number | null;
          ended: number | null;
          waited_for: string | null;
          done_by?: string | null;
          /** Items: What came of reminding one person. */
          reminded?: {
            person: string;
            result: 'away' | 'broken_off' | 'gone' | 'no' | 'silent' | 'unclear' | 'yes';
            what?: string;
            said?: number | null;
            place?: string | null;
            question?: string;
            answer?: string | null;
          }[];
        };
        sentence: string;
        told: string;
      }[];
    };
    /**
     * Tell the week with that day in it (this one, without a `date`), from Monday to Sunday: each time with what came of it or whether it will be done (coming, called off, paused, not approved), and when it is by the clocks of the house.
     */
    week: {
      params: {
        date?: string;
        language?: string;
      };
      /** From a Monday to a Sunday. */
      result: {
        zone: string;
        now: number;
        today: string;
        at: string;
        days: string[];
        /** Items: A time at which an appointment is due. */
        times: {
          appointment: number;
          sentence: string;
          when: string;
          due: number;
          day: string;
          at: string;
          state:
            | ('asked' | 'claimed' | 'done' | 'due' | 'failed' | 'missed' | 'running' | 'skipped')
            | ('coming' | 'off' | 'paused' | 'unapproved');
          told: string;
          run: number | null;
        }[];
        more: boolean;
      };
    };
    /**
     * List the latest reminders, or those since a moment (seconds since the epoch), the newest first: when each was due and said, to whom, where, and what came of it (yes, no, unclear, silent, away: not found, gone: not there any more when asked, broken_off, or what became of a time at which it was not said). A program reminds somebody if it keeps the answer to a question of its own as `reminder_done`.
     */
    reminders: {
      params: {
        since?: number;
        last?: number;
        language?: string;
      };
      /** Items: A person reminded, or not. Times are seconds since the epoch. */
      result: {
        due: number;
        said: number | null;
        person: string;
        what: string;
        place: string | null;
        result:
          | ('away' | 'broken_off' | 'gone' | 'no' | 'silent' | 'unclear' | 'yes')
          | ('asked' | 'claimed' | 'done' | 'due' | 'failed' | 'missed' | 'running' | 'skipped');
        told: string;
        question: string;
        answer: string | null;
        robot: string;
        approved_by: string;
        sentence: string;
        appointment: number | null;
        occurrence: number | null;
        run: number | null;
      }[];
    };
    /**
     * List the newest notices, or those with a higher number than `after`: what somebody has to know of an appointment who was not looking. The newest is the last.
     */
    notices: {
      params: {
        after?: number;
        last?: number;
        language?: string;
      };
      /** Items: A notice with its sentence. */
      result: {
        /**
         * Something that somebody has to know who was not looking. `nl2robot.schedule.telling.told`
         *     makes a sentence of it.
         */
        notice: {
          id: number;
          time: number;
          kind:
            | 'broken_off'
            | 'changed'
            | 'ended'
            | 'ends_soon'
            | 'failed'
            | 'missed'
            | 'missed_many'
            | 'moved'
            | 'overtaken'
            | 'refused'
            | 'reminder_away'
            | 'reminder_gone'
            | 'reminder_no'
            | 'reminder_silent'
            | 'reminder_unclear'
            | 'trouble'
            | 'waits';
          appointment: number;
          occurrence: number | null;
          parts: {
            [k: string]: unknown;
          };
        };
        told: string;
      }[];
    };
  };
  proposal: {
    /**
     * Lay a program before those who decide: `sentence` says what it is to do, `why` what they should know. It is reviewed at once; one with an error is refused. It runs when somebody approves it, and waits ten minutes for that.
     */
    make: {
      params: {
        program: string;
        sentence: string;
        by: string;
        why?: string;
        language?: string;
      };
      /** A proposal that waits, with what its review says to whoever made it. */
      result: {
        /** A program that somebody proposes, and what came of it. */
        proposal: {
          id: number;
          program: string;
          sha256: string;
          sentence: string;
          why?: string;
          by: string;
          account?: string;
          connection?: string;
          language: string;
          at: number;
          until: number;
          state?: 'approved' | 'declined' | 'expired' | 'waiting' | 'withdrawn';
          decided_at?: number | null;
          decided_by?: string | null;
          reason?: string | null;
          run?: number | null;
          ran?: string | null;
        };
        /** What a person should know before approving a program. */
        review: {
          program: string;
          sha256: string;
          /**
           * Items: Something wrong ("error": the program will not be run) or doubtful ("warning").
           */
          findings: {
            line: number;
            column: number;
            severity: 'error' | 'warning';
            code: string;
            message: string;
          }[];
          /** Items: A line of the program in plain words. */
          reading: {
            line: number;
            depth: number;
            text: string;
          }[];
          dry_run: {
            status: 'done' | 'failed' | 'limit' | 'stopped' | 'unfinished';
            message: string | null;
            line: number | null;
            seconds: number;
            metres: number;
            says: string[];
            asks: string[];
            holds: string[];
            shows: string[];
            places: string[];
            path: never[][];
            calls: number;
            /**
             * Items: Something that would happen: a place reached, words spoken, asked or shown, a thing moved.
             */
            course?: {
              kind: 'asked' | 'gave' | 'put' | 'said' | 'showed' | 'took' | 'was at';
              what: string;
            }[];
            closed?: string[];
            error?: string | null;
            broke_off?: ('calls' | 'computing' | 'machine' | 'time') | null;
            goes_on?: boolean;
          } | null;
          /** Items: Something to think about, and where it is in the program. */
          risks?: {
            line: number;
            kind:
              'endless' | 'leaves' | 'long' | 'person' | 'speed' | 'unproven' | 'volume' | 'zone';
            text: string;
          }[];
        };
      };
    };
    /** List the proposals since the server began, the newest last. */
    list: {
      params: Record<string, never>;
      /** Items: A program that somebody proposes, and what came of it. */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        why?: string;
        by: string;
        account?: string;
        connection?: string;
        language: string;
        at: number;
        until: number;
        state?: 'approved' | 'declined' | 'expired' | 'waiting' | 'withdrawn';
        decided_at?: number | null;
        decided_by?: string | null;
        reason?: string | null;
        run?: number | null;
        ran?: string | null;
      }[];
    };
    /** Tell how a proposal stands. */
    show: {
      params: {
        id: number;
      };
      /** A program that somebody proposes, and what came of it. */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        why?: string;
        by: string;
        account?: string;
        connection?: string;
        language: string;
        at: number;
        until: number;
        state?: 'approved' | 'declined' | 'expired' | 'waiting' | 'withdrawn';
        decided_at?: number | null;
        decided_by?: string | null;
        reason?: string | null;
        run?: number | null;
        ran?: string | null;
      };
    };
    /**
     * Wait until a proposal is decided, `timeout` seconds at most, and tell how it stands.
     */
    wait: {
      params: {
        id: number;
        timeout?: number;
      };
      /** A program that somebody proposes, and what came of it. */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        why?: string;
        by: string;
        account?: string;
        connection?: string;
        language: string;
        at: number;
        until: number;
        state?: 'approved' | 'declined' | 'expired' | 'waiting' | 'withdrawn';
        decided_at?: number | null;
        decided_by?: string | null;
        reason?: string | null;
        run?: number | null;
        ran?: string | null;
      };
    };
    /** Take back a proposal that is not decided, and one's own. */
    withdraw: {
      params: {
        id: number;
      };
      /** A program that somebody proposes, and what came of it. */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        why?: string;
        by: string;
        account?: string;
        connection?: string;
        language: string;
        at: number;
        until: number;
        state?: 'approved' | 'declined' | 'expired' | 'waiting' | 'withdrawn';
        decided_at?: number | null;
        decided_by?: string | null;
        reason?: string | null;
        run?: number | null;
        ran?: string | null;
      };
    };
    /**
     * Approve exactly the proposed program with this SHA-256, or the `program` that somebody made of it by hand, and begin it at once; `run` is its run. One that does not come to its end in the dry run is refused unless somebody `insists`.
     */
    approve: {
      params: {
        id: number;
        sha256: string;
        by: string;
        program?: string;
        insists?: boolean;
      };
      /** A program that somebody proposes, and what came of it. */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        why?: string;
        by: string;
        account?: string;
        connection?: string;
        language: string;
        at: number;
        until: number;
        state?: 'approved' | 'declined' | 'expired' | 'waiting' | 'withdrawn';
        decided_at?: number | null;
        decided_by?: string | null;
        reason?: string | null;
        run?: number | null;
        ran?: string | null;
      };
    };
    /** Say no to a proposal, and why. */
    decline: {
      params: {
        id: number;
        by: string;
        reason?: string;
      };
      /** A program that somebody proposes, and what came of it. */
      result: {
        id: number;
        program: string;
        sha256: string;
        sentence: string;
        why?: string;
        by: string;
        account?: string;
        connection?: string;
        language: string;
        at: number;
        until: number;
        state?: 'approved' | 'declined' | 'expired' | 'waiting' | 'withdrawn';
        decided_at?: number | null;
        decided_by?: string | null;
        reason?: string | null;
        run?: number | null;
        ran?: string | null;
      };
    };
  };
  fleet: {
    /**
     * List the robots of the fleet as this one has heard of them, and what it has given them to do, the newest first. `heard` is how many seconds ago by the clock here; one that is not `known` may stand any way. `trouble`: why the fleet is not reached, by language, if it is not.
     */
    list: {
      params: Record<string, never>;
      /**
       * The robots of the fleet, and what this one has given them to do, the newest first.
       */
      result: {
        /**
         * Items: Something that this robot's dispatcher has to have done once, by some robot.
         */
        errands: {
          id: string;
          program: string;
          sha256: string;
          sentence: string;
          language: string;
          by: string;
          reviewed: string;
          at: number;
          until?: number | null;
          wanted?: string | null;
          state?: string;
          offer?: string | null;
          robot?: string | null;
          robot_name?: string | null;
          session?: string;
          run?: number | null;
          message?: string | null;
          refused?: {
            [k: string]: string;
          };
          /** Items: What came of reminding one person. */
          reminded?: {
            person: string;
            result: 'away' | 'broken_off' | 'gone' | 'no' | 'silent' | 'unclear' | 'yes';
            what?: string;
            said?: number | null;
            place?: string | null;
            question?: string;
            answer?: string | null;
          }[];
        }[];
        /**
         * Items: A robot of the fleet as this one has heard of it; `heard`: seconds ago by the clock here.
         */
        members: {
          about: {
            name: string;
            kind: string;
            methods: string[];
            world: string;
            map: string;
            version: string;
          } | null;
          heard: number;
          here: boolean;
          id: string;
          known: boolean;
          left: boolean;
          name: string;
          same_map: boolean;
          standing: {
            state: string;
            x?: number | null;
            y?: number | null;
            theta?: number | null;
            place?: string | null;
            battery?: number | null;
            charging?: boolean;
            run?: number | null;
            because?: string | null;
            driven_by?: string | null;
            zones?: string;
            plans?: string | null;
            waits?: string | null;
          } | null;
          twin: boolean;
        }[];
        trouble: {
          [k: string]: string;
        } | null;
      };
    };
    /**
     * List the appointments of the fleet: each is kept by the robot where it was made, which has it handed out at its time to the one that does it best. Of one whose keeper is not `known`, `planned.unknown` is the last time of which nobody knows whether it was done. `planned.next` is when it is done if its keeper is there then.
     */
    plans: {
      params: {
        language?: string;
      };
      /** Items: An appointment of the fleet, and who keeps it. */
      result: {
        robot: string;
        name: string;
        here: boolean;
        known: boolean;
        /** A plan as it is shown. */
        planned: {
          /**
           * An appointment of the fleet. Times are seconds since the epoch, by its keeper's clock.
           */
          plan: {
            number: number;
            sentence: string;
            language: string;
            rhythm: {
              begins: string;
              zone: string;
              rule?: string | null;
            } | null;
            trigger: {
              what: 'battery' | 'heard' | 'message' | 'place' | 'pressed' | 'scanned' | 'seen';
              text?: string;
              thing?: string;
              place?: string;
              topic?: string;
              below?: number;
              every?: number;
            } | null;
            approved_by: string;
            approved_until: number;
            paused: boolean;
            asked: ('changed' | 'ended' | 'moved') | null;
            off: number[];
            looked: number;
            latest: {
              id: number;
              appointment: number;
              due: number;
              state:
                'asked' | 'claimed' | 'done' | 'due' | 'failed' | 'missed' | 'running' | 'skipped';
              run: number | null;
              note: string | null;
              process: number | null;
              began: number | null;
              ended: number | null;
              waited_for: string | null;
              done_by?: string | null;
              /** Items: What came of reminding one person. */
              reminded?: {
                person: string;
                result: 'away' | 'broken_off' | 'gone' | 'no' | 'silent' | 'unclear' | 'yes';
                what?: string;
                said?: number | null;
                place?: string | null;
                question?: string;
                answer?: string | null;
              }[];
            } | null;
          };
          when: string;
          next: number[];
          unknown: number | null;
          told: string;
        };
      }[];
    };
    /**
     * Tell the id of the robot of that name or id. Refuses one that is none of the fleet, has another floor, or lacks a method that the program calls; whether it is free now is nothing to this.
     */
    fit: {
      params: {
        robot: string;
        program: string;
      };
      result: string;
    };
    /**
     * Approve exactly the program with this SHA-256, for one run by the robot of the fleet that does it best, or by the `robot` of that name or id. That robot reviews it again before it begins. Returns what is to be done, which `fleet.wait` waits for.
     */
    run: {
      params: {
        program: string;
        sha256: string;
        by: string;
        sentence?: string;
        language?: string;
        robot?: string;
      };
      /** Something that this robot's dispatcher has to have done once, by some robot. */
      result: {
        id: string;
        program: string;
        sha256: string;
        sentence: string;
        language: string;
        by: string;
        reviewed: string;
        at: number;
        until?: number | null;
        wanted?: string | null;
        state?: string;
        offer?: string | null;
        robot?: string | null;
        robot_name?: string | null;
        session?: string;
        run?: number | null;
        message?: string | null;
        refused?: {
          [k: string]: string;
        };
        /** Items: What came of reminding one person. */
        reminded?: {
          person: string;
          result: 'away' | 'broken_off' | 'gone' | 'no' | 'silent' | 'unclear' | 'yes';
          what?: string;
          said?: number | null;
          place?: string | null;
          question?: string;
          answer?: string | null;
        }[];
      };
    };
    /**
     * Wait until something that was given to the fleet is over, `timeout` seconds at most, and tell how it stands.
     */
    wait: {
      params: {
        errand: string;
        timeout?: number;
      };
      /** Something that this robot's dispatcher has to have done once, by some robot. */
      result: {
        id: string;
        program: string;
        sha256: string;
        sentence: string;
        language: string;
        by: string;
        reviewed: string;
        at: number;
        until?: number | null;
        wanted?: string | null;
        state?: string;
        offer?: string | null;
        robot?: string | null;
        robot_name?: string | null;
        session?: string;
        run?: number | null;
        message?: string | null;
        refused?: {
          [k: string]: string;
        };
        /** Items: What came of reminding one person. */
        reminded?: {
          person: string;
          result: 'away' | 'broken_off' | 'gone' | 'no' | 'silent' | 'unclear' | 'yes';
          what?: string;
          said?: number | null;
          place?: string | null;
          question?: string;
          answer?: string | null;
        }[];
      };
    };
    /** Have something not done that no robot was told to begin yet. */
    call_off: {
      params: {
        errand: string;
      };
      /** Something that this robot's dispatcher has to have done once, by some robot. */
      result: {
        id: string;
        program: string;
        sha256: string;
        sentence: string;
        language: string;
        by: string;
        reviewed: string;
        at: number;
        until?: number | null;
        wanted?: string | null;
        state?: string;
        offer?: string | null;
        robot?: string | null;
        robot_name?: string | null;
        session?: string;
        run?: number | null;
        message?: string | null;
        refused?: {
          [k: string]: string;
        };
        /** Items: What came of reminding one person. */
        reminded?: {
          person: string;
          result: 'away' | 'broken_off' | 'gone' | 'no' | 'silent' | 'unclear' | 'yes';
          what?: string;
          said?: number | null;
          place?: string | null;
          question?: string;
          answer?: string | null;
        }[];
      };
    };
    /**
     * Stop all robots of the fleet, or the `robot` of that name or id; returns what each says to that. One that has not `answered` may still move.
     */
    stop: {
      params: {
        robot?: string;
      };
      /** Items: A robot's answer to a stop. */
      result: {
        id: string;
        name: string;
        confirmed: boolean;
        answered: boolean;
        because: string;
      }[];
    };
  };
  desk: {
    /**
     * Review a program as `program.check` does, told as the desk tells it: the outcome, whether that is good, facts (a heading with its items), marks on the lines, and each line in plain words (line, depth, text). With `at`, as if it began then.
     */
    check: {
      params: {
        program: string;
        language?: string;
        at?: string;
      };
      /** A review as the desk tells it; `reading` is line, depth, text. */
      result: {
        acceptable: boolean;
        came_through: boolean;
        facts: never[][];
        good: boolean;
        /** Items: Something to know of a line. */
        marks: {
          line: number;
          text: string;
          weight: 'error' | 'note' | 'risk';
        }[];
        outcome: string;
        reading: never[][];
        sha256: string;
      };
    };
    /** Tell how the present or last run stands, with its program and calls. */
    run: {
      params: {
        language?: string;
      };
      result: {
        by: string | null;
        /** Items: A call of a run. */
        calls: {
          arguments: {
            [k: string]: unknown;
          };
          error: string | null;
          line: number;
          method: string;
          number: number;
          result: unknown;
          seconds: number | null;
        }[];
        error: string | null;
        line: number | null;
        /** Items: A line of a program: its HTML, and what it says. */
        lines: {
          code: string;
          reading: string;
        }[];
        message: string | null;
        program: string;
        robot_lost_since: number | null;
        run: number;
        sha256: string;
        started: number | null;
        state: 'done' | 'failed' | 'limit' | 'paused' | 'pausing' | 'running' | 'stopped';
        utterance: string | null;
      } | null;
    };
  };
  scene: {
    /**
     * Tell what the floor looks like, the robot's trail, the scene as it is now, and the map's texts.
     */
    floor: {
      params: {
        language?: 'en' | 'de' | 'fr';
      };
      result: {
        [k: string]: unknown;
      };
    };
  };
  zones: {
    /** List the keep-out zones: name, polygon, and whether it can be removed. */
    list: {
      params: Record<string, never>;
      /** Items: A zone, its corners in metres. */
      result: {
        name: string;
        polygon: number[][];
        removable: boolean;
      }[];
    };
    /**
     * Keep the robot out of an area from now on; returns the zones as zones.list does. `who` does it, for the history.
     */
    set: {
      params: {
        name: string;
        /** @maxItems 1000 */
        polygon: number[][];
        who?: string;
      };
      /** Items: A zone, its corners in metres. */
      result: {
        name: string;
        polygon: number[][];
        removable: boolean;
      }[];
    };
    /** Remove a keep-out zone that was drawn; returns the zones as zones.list does. */
    remove: {
      params: {
        name: string;
        who?: string;
      };
      /** Items: A zone, its corners in metres. */
      result: {
        name: string;
        polygon: number[][];
        removable: boolean;
      }[];
    };
    /**
     * List the last changes of keep-out zones, the newest first: number, when (seconds since the epoch), who, what (drawn | changed | removed), name, the change that it undoes or null, and whether it can be undone.
     */
    history: {
      params: Record<string, never>;
      /** Items: A change, as it is told on the wire. */
      result: {
        name: string;
        number: number;
        undoable: boolean;
        undoes: number | null;
        what: 'changed' | 'drawn' | 'removed';
        when: number;
        who: string;
      }[];
    };
    /**
     * Take back the change of that number; returns the zones as zones.list does. That can be undone as well.
     */
    undo: {
      params: {
        change: number;
        who?: string;
      };
      /** Items: A zone, its corners in metres. */
      result: {
        name: string;
        polygon: number[][];
        removable: boolean;
      }[];
    };
  };
  places: {
    /**
     * List the places as the map shows them, each with whether it was named by hand: then it is removable, and has its aliases.
     */
    list: {
      params: Record<string, never>;
      /**
       * Items: A place as the map shows it: `pose` is x, y (metres) and the way to face (degrees).
       */
      result: {
        aliases?: {
          [k: string]: string[];
        };
        area: number[][] | null;
        kind: string;
        name: string;
        names: {
          [k: string]: string;
        };
        part: boolean;
        pose: number[] | null;
        removable: boolean;
      }[];
    };
    /**
     * Name a place, or change the one that `was` called so. Returns the places, and by how many metres it was `moved` to where the robot has room and blocks no door.
     */
    set: {
      params: {
        name: string;
        kind?: string;
        was?: string;
        aliases?: {
          /** @maxItems 10 */
          [k: string]: string[];
        };
        x: number;
        y: number;
        theta?: number;
      };
      /** All places, and by how many metres the one that was named was put aside. */
      result: {
        moved: number;
        /**
         * Items: A place as the map shows it: `pose` is x, y (metres) and the way to face (degrees).
         */
        places: {
          aliases?: {
            [k: string]: string[];
          };
          area: number[][] | null;
          kind: string;
          name: string;
          names: {
            [k: string]: string;
          };
          part: boolean;
          pose: number[] | null;
          removable: boolean;
        }[];
      };
    };
    /** Remove a place that was named by hand; returns the places as places.set does. */
    remove: {
      params: {
        name: string;
      };
      /** All places, and by how many metres the one that was named was put aside. */
      result: {
        moved: number;
        /**
         * Items: A place as the map shows it: `pose` is x, y (metres) and the way to face (degrees).
         */
        places: {
          aliases?: {
            [k: string]: string[];
          };
          area: number[][] | null;
          kind: string;
          name: string;
          names: {
            [k: string]: string;
          };
          part: boolean;
          pose: number[] | null;
          removable: boolean;
        }[];
      };
    };
    /** Give the world's file with the places and zones in it that were drawn by hand. */
    export: {
      params: Record<string, never>;
      /** A file to keep, by its name. */
      result: {
        file: string;
        text: string;
      };
    };
    /**
     * Tell what a spot or a place on the map means as a goal: the nearest spot where the robot has room and blocks no door, by how many metres that was moved, what people call it, and the program that goes there. Moves nothing.
     */
    aim: {
      params: {
        x: number;
        y: number;
        place?: string | null;
        language?: 'en' | 'de' | 'fr';
      };
      /** What is meant by a spot on the map. */
      result: {
        x: number;
        y: number;
        place: string | null;
        moved: number;
        program: string;
        said: string;
        note: string;
      };
    };
  };
  location: {
    /**
     * Tell the robot where it is, as `robot.localize`, so that it can be undone; returns the history.
     */
    set: {
      params: {
        x?: number;
        y?: number;
        theta?: number;
        who?: string;
        place?: string;
      };
      /** Items: A correction, as it is told on the wire. */
      result: {
        /** Metres, and degrees. */
        after: {
          place: string | null;
          theta: number;
          x: number;
          y: number;
        };
        /** Metres, and degrees. */
        before: {
          place: string | null;
          theta: number;
          x: number;
          y: number;
        };
        number: number;
        undoable: boolean;
        undoes: number | null;
        when: number;
        who: string;
      }[];
    };
    /**
     * List who told the robot where it is, the newest first: number, when (seconds since the epoch), who, before and after (x, y, theta, place), the correction that it undoes or null, and whether it can be undone.
     */
    history: {
      params: Record<string, never>;
      /** Items: A correction, as it is told on the wire. */
      result: {
        /** Metres, and degrees. */
        after: {
          place: string | null;
          theta: number;
          x: number;
          y: number;
        };
        /** Metres, and degrees. */
        before: {
          place: string | null;
          theta: number;
          x: number;
          y: number;
        };
        number: number;
        undoable: boolean;
        undoes: number | null;
        when: number;
        who: string;
      }[];
    };
    /**
     * Take back the last correction, wherever the robot has driven since; returns the history. That can be undone as well.
     */
    undo: {
      params: {
        correction: number;
        who?: string;
      };
      /** Items: A correction, as it is told on the wire. */
      result: {
        /** Metres, and degrees. */
        after: {
          place: string | null;
          theta: number;
          x: number;
          y: number;
        };
        /** Metres, and degrees. */
        before: {
          place: string | null;
          theta: number;
          x: number;
          y: number;
        };
        number: number;
        undoable: boolean;
        undoes: number | null;
        when: number;
        who: string;
      }[];
    };
  };
  helm: {
    /** Tell who drives, and who asks to. */
    state: {
      params: Record<string, never>;
      /** Who drives, and which of the connections is the asker's own. */
      result: {
        /** Items: Somebody at a console. */
        asking: {
          connection: string;
          who: string;
        }[];
        driver: string | null;
        me: string;
        since: number | null;
        who: string | null;
      };
    };
    /** Drive, if nobody does; else ask whoever does, with the event `helm`. */
    take: {
      params: {
        who: string;
      };
      /** Who drives, and which of the connections is the asker's own. */
      result: {
        /** Items: Somebody at a console. */
        asking: {
          connection: string;
          who: string;
        }[];
        driver: string | null;
        me: string;
        since: number | null;
        who: string | null;
      };
    };
    /** Hand the helm over to a connection that asks; without one, let it go. */
    give: {
      params: {
        to?: string | null;
      };
      /** Who drives, and which of the connections is the asker's own. */
      result: {
        /** Items: Somebody at a console. */
        asking: {
          connection: string;
          who: string;
        }[];
        driver: string | null;
        me: string;
        since: number | null;
        who: string | null;
      };
    };
    /** Tell those who ask that you go on driving. */
    keep: {
      params: Record<string, never>;
      /** Who drives, and which of the connections is the asker's own. */
      result: {
        /** Items: Somebody at a console. */
        asking: {
          connection: string;
          who: string;
        }[];
        driver: string | null;
        me: string;
        since: number | null;
        who: string | null;
      };
    };
    /**
     * A robot method, by name, with its arguments, from whoever drives; returns its result. Ends with the connection. `stop` may be called by every operator.
     */
    call: {
      params: {
        name: string;
        arguments?: {
          [k: string]: unknown;
        };
      };
      result: unknown;
    };
    /**
     * Move the joystick: metres and degrees a second, for 0.3 s at most; a newer one takes over. With numbers that count up, a late one does not overtake.
     */
    drive: {
      params: {
        linear: number;
        angular: number;
        number?: number;
      };
      result: null;
    };
    /** Let go of the joystick: the robot stands. */
    release: {
      params: {
        number?: number;
      };
      result: null;
    };
    /** What this robot can do, where it can go, and how it is just now. */
    body: {
      params: Record<string, never>;
      result: {
        [k: string]: unknown;
      };
    };
    /** The last lines of the log: level, message, time. */
    log: {
      params: {
        lines?: number;
      };
      /** Items: `time` is the local one, as 14:05:00. */
      result: {
        level: string;
        message: string;
        time: string;
      }[];
    };
  };
  face: {
    /** Tell what the robot's face shows. */
    state: {
      params: Record<string, never>;
      /** What a face shows, as the event `face` says. */
      result: {
        asking: {
          [k: string]: unknown;
        } | null;
        chosen: boolean;
        emotion: string;
        language: string;
        lost: number | null;
        mood: string | null;
        robot:
          | 'charging'
          | 'idle'
          | 'lost'
          | 'paused'
          | 'pausing'
          | 'reviewing'
          | 'running'
          | 'stopped'
          | 'stopping';
        screen: {
          [k: string]: unknown;
        };
        speech: {
          [k: string]: unknown;
        } | null;
        stopped: number | null;
        unconfirmed: boolean;
        version: number;
      };
    };
    /**
     * Be a face of the robot: people may touch it. Tells what to show, and its own name.
     */
    here: {
      params: {
        visible: boolean;
      };
      /** The same, and the face's own name. */
      result: {
        asking: {
          [k: string]: unknown;
        } | null;
        chosen: boolean;
        emotion: string;
        language: string;
        lost: number | null;
        mood: string | null;
        name: string;
        robot:
          | 'charging'
          | 'idle'
          | 'lost'
          | 'paused'
          | 'pausing'
          | 'reviewing'
          | 'running'
          | 'stopped'
          | 'stopping';
        screen: {
          [k: string]: unknown;
        };
        speech: {
          [k: string]: unknown;
        } | null;
        stopped: number | null;
        unconfirmed: boolean;
        version: number;
      };
    };
    /** Answer what is asked on the screen; the result says whether nobody was faster. */
    touch: {
      params: {
        number: number;
        answer: string;
      };
      result: boolean;
    };
    /**
     * Answer, from the desk, for whoever is asked and is silent or not there; the run's log says so, with `who`. The result says whether nobody was faster.
     */
    stand_in: {
      params: {
        number: number;
        answer: string;
        who: string;
        language?: 'en' | 'de' | 'fr';
      };
      result: boolean;
    };
    /** Tell what people have made of the page of HTML that is shown. */
    page: {
      params: {
        page: number;
        html: string;
      };
      result: null;
    };
    /** Tell how the page is after a "face.act"; null if it could not be done. */
    did: {
      params: {
        number: number;
        html: string | null;
      };
      result: null;
    };
    /**
     * Tell that somebody touches the web page that is shown, which tells nothing itself.
     */
    used: {
      params: Record<string, never>;
      result: null;
    };
    /** Let the robot speak and hear this language from now on. */
    language: {
      params: {
        code: 'en' | 'de' | 'fr';
      };
      result: null;
    };
    /**
     * Tell whether the web page at the address that is shown lets itself be shown here: yes, refuses or away.
     */
    site: {
      params: Record<string, never>;
      result: 'away' | 'refuses' | 'yes';
    };
  };
  call: {
    /** Let this page be rung up, as the robot's face or as an operator's. */
    ready: {
      params: {
        side: 'face' | 'operator';
      };
      result: null;
    };
    /** Call the robot: its faces ring. */
    start: {
      params: {
        who: string;
      };
      result: number;
    };
    /** Take the call that rings here; the result says whether it still rang. */
    answer: {
      params: {
        call: number;
      };
      result: boolean;
    };
    /**
     * Go on with a call that another page of this browser was in; the result says whether it still is.
     */
    resume: {
      params: {
        call: number;
        key: string;
      };
      result: boolean;
    };
    /** End the call, or decline the one that rings here. */
    end: {
      params: {
        call: number;
        because?: 'hung_up' | 'lost' | 'no_way';
      };
      result: null;
    };
    /** Tell the other side's WebRTC connection something. */
    signal: {
      params: {
        call: number;
        signal: {
          [k: string]: unknown;
        };
      };
      result: null;
    };
  };
  runs: {
    /**
     * List past runs, newest first: those with all these words, in this state, of these days (2026-11-24), older than the run `before`.
     */
    list: {
      params: {
        words?: string;
        state?: '' | 'running' | 'done' | 'failed' | 'stopped' | 'limit' | 'interrupted';
        since?: string;
        until?: string;
        before?: number;
      };
      /**
       * Some runs; `found`: how many there are in all, `more`: whether there are older ones.
       */
      result: {
        found: number;
        more: boolean;
        /** Items: `nl2robot.run.archive.Brief`, with its state. */
        runs: {
          approved_by: string;
          calls: number;
          changed_by: string | null;
          finished: number | null;
          heard: string | null;
          id: number;
          message: string | null;
          process: number | null;
          program: string;
          proposed: string | null;
          robot: string | null;
          started: number;
          state: 'done' | 'failed' | 'interrupted' | 'limit' | 'running' | 'stopped';
          status: string | null;
          utterance: string | null;
          world: string | null;
        }[];
      };
    };
    /** Everything that is logged of a run. */
    show: {
      params: {
        run: number;
      };
      result: {
        [k: string]: unknown;
      };
    };
  };
  routines: {
    /** List the routines: what each does, who taught it, how often it was run. */
    list: {
      params: {
        reader?: 'en' | 'de' | 'fr';
      };
      /**
       * Items: A routine for the wire; `steps` are depth and text, times ISO 8601, local.
       */
      result: {
        by: string;
        changed: string;
        changed_by: string;
        does: string;
        formerly: string[];
        imported: string;
        language: string;
        learned: string;
        name: string;
        program: string;
        reviewed: boolean;
        reviewed_by: string;
        runs: number | null;
        sentence: string;
        sha256: string;
        steps: never[][];
        works: boolean;
        written: string;
      }[];
    };
    /** Tell all about a routine. */
    show: {
      params: {
        name: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
      };
      /** A routine for the wire; `steps` are depth and text, times ISO 8601, local. */
      result: {
        by: string;
        changed: string;
        changed_by: string;
        does: string;
        formerly: string[];
        imported: string;
        language: string;
        learned: string;
        name: string;
        program: string;
        reviewed: boolean;
        reviewed_by: string;
        runs: number | null;
        sentence: string;
        sha256: string;
        steps: never[][];
        works: boolean;
        written: string;
      };
    };
    /** Tell what a sentence or a program would do as a routine; keeps nothing. */
    check: {
      params: {
        name?: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
        sentence?: string;
        program?: string;
      };
      /** What a sentence or a program would do; `name`: why it can have no such name. */
      result: {
        does: string;
        name: string | null;
        steps: never[][];
        works: boolean;
        written: string;
      };
    };
    /** Try a routine in a copy of the simulated world, with its picture; moves nothing. */
    test: {
      params: {
        name: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
      };
      /** A dry run; `picture` is an SVG of its way. */
      result: {
        facts: never[][];
        good: boolean;
        /** Items: Something to know of a line. */
        marks: {
          line: number;
          text: string;
          weight: 'error' | 'note' | 'risk';
        }[];
        outcome: string;
        picture: string | null;
      };
    };
    /** Keep a sentence or a program under a name that can be said. */
    keep: {
      params: {
        name: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
        sentence?: string;
        program?: string;
        by?: string;
      };
      /** A routine for the wire; `steps` are depth and text, times ISO 8601, local. */
      result: {
        by: string;
        changed: string;
        changed_by: string;
        does: string;
        formerly: string[];
        imported: string;
        language: string;
        learned: string;
        name: string;
        program: string;
        reviewed: boolean;
        reviewed_by: string;
        runs: number | null;
        sentence: string;
        sha256: string;
        steps: never[][];
        works: boolean;
        written: string;
      };
    };
    /** Let a routine do something else from now on. */
    change: {
      params: {
        name: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
        sentence?: string;
        program?: string;
        by?: string;
      };
      /** A routine for the wire; `steps` are depth and text, times ISO 8601, local. */
      result: {
        by: string;
        changed: string;
        changed_by: string;
        does: string;
        formerly: string[];
        imported: string;
        language: string;
        learned: string;
        name: string;
        program: string;
        reviewed: boolean;
        reviewed_by: string;
        runs: number | null;
        sentence: string;
        sha256: string;
        steps: never[][];
        works: boolean;
        written: string;
      };
    };
    /** Call a routine otherwise. */
    rename: {
      params: {
        name: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
        new: string;
      };
      /**
       * `used_by`: the names of the routines that need it, with commas between; maybe empty.
       */
      result: {
        name: string;
        used_by: string;
      };
    };
    /** Let an imported routine be used, whose body with this SHA-256 was reviewed. */
    accept: {
      params: {
        name: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
        sha256: string;
        by?: string;
      };
      /** A routine for the wire; `steps` are depth and text, times ISO 8601, local. */
      result: {
        by: string;
        changed: string;
        changed_by: string;
        does: string;
        formerly: string[];
        imported: string;
        language: string;
        learned: string;
        name: string;
        program: string;
        reviewed: boolean;
        reviewed_by: string;
        runs: number | null;
        sentence: string;
        sha256: string;
        steps: never[][];
        works: boolean;
        written: string;
      };
    };
    /** Forget a routine; returns a number with which it can be restored. */
    remove: {
      params: {
        name: string;
        language: string;
        reader?: 'en' | 'de' | 'fr';
      };
      /** `number`: with which it can be restored. */
      result: {
        number: number;
        used_by: string;
      };
    };
    /** Undo a removal. */
    restore: {
      params: {
        number: number;
      };
      result: null;
    };
    /** Give routines as a file: those that are named, or all. */
    export: {
      params: {
        /** @maxItems 200 */
        which?: {
          name: string;
          language: string;
        }[];
      };
      /** A file to keep, by its name. */
      result: {
        file: string;
        text: string;
      };
    };
    /**
     * Look at a file of routines; with `keep`, take those over. What is taken over cannot be used before routines.accept.
     */
    import: {
      params: {
        text: string;
        file?: string;
        reader?: 'en' | 'de' | 'fr';
        /** @maxItems 200 */
        keep?: {
          number: number;
          name: string;
          replace?: boolean;
        }[];
      };
      /** What is in a file, or what of it was taken over. */
      result: {
        /** Items: A routine of a file, and how it stands to those that are known. */
        found?: {
          does: string;
          language: string;
          line: number;
          name: string;
          sentence: string;
          state: 'new' | 'same' | 'taken' | 'unfit';
          steps: never[][];
          why: string;
          works: boolean;
          written: string;
        }[];
        /** Items: A routine that was taken over. */
        kept?: {
          language: string;
          name: string;
        }[];
      };
    };
  };
  devices: {
    /**
     * List what tablets and people came in by, and who failed to; for administrators the accounts as well.
     */
    list: {
      params: Record<string, never>;
      /** What tablets and people came in by, and who failed to. */
      result: {
        accounts?: {
          name: string;
          role: 'administrator' | 'assistant' | 'face' | 'observer' | 'operator';
          made: number;
        }[];
        /** Items: `nl2robot.station.accounts.Session`, and whether it is the asker's own. */
        devices: {
          account: string | null;
          id: number;
          label: string;
          link: boolean;
          made: number;
          made_by: string | null;
          mine: boolean;
          role: 'administrator' | 'assistant' | 'face' | 'observer' | 'operator';
          used: number;
        }[];
        failures: {
          time: number;
          name: string;
          address: string;
        }[];
        here_only: boolean;
      };
    };
    /** Make a link by which one tablet comes in within ten minutes, and its QR code. */
    pair: {
      params: {
        role: 'face' | 'observer' | 'operator';
        label: string;
        at?: string;
      };
      /** A link by which one tablet comes in, its QR code as a data URL, and until when. */
      result: {
        ends: number | null;
        link: string;
        picture: string;
      };
    };
    /**
     * Let nobody come in by this any more; whoever is connected by it is not from then on.
     */
    withdraw: {
      params: {
        device: number;
      };
      result: null;
    };
  };
}

export type ErrorName =
  | 'RobotError'
  | 'UnknownPlace'
  | 'UnknownPerson'
  | 'NotFound'
  | 'NotPossible'
  | 'Blocked'
  | 'TimedOut'
  | 'NotSupported'
  | 'InvalidCall'
  | 'AccessDenied'
  | 'NotTrusted'
  | 'LostConnection'
  | 'StopNotConfirmed'
  | 'InternalError'
  | 'Stopped';

export interface Events {
  /**
   * x, y (metres), theta (degrees), place, speed (m/s), time (s); 10 a second when moving
   */
  pose: any;
  /**
   * metres: distances to what is around it, evenly round it from straight ahead to the left, null where nothing is in reach; at most 5 a second
   */
  lidar: any;
  /** text, language: the robot speaks */
  speech: any;
  /** text, person: somebody answered */
  heard: any;
  /** code: the robot speaks and hears it from now on */
  language: any;
  /** text | html | url | options: what the screen shows */
  screen: any;
  /** name */
  emotion: any;
  /** name */
  gesture: any;
  /** percent: how loud the robot is from now on */
  volume: any;
  /** name, degrees: how a joint stands from now on */
  joint: any;
  /** contact, state: a video call */
  call: any;
  /** percent, charging */
  battery: any;
  /** level, message, time */
  log: any;
  /**
   * audio (a WAV file in base64), seconds: the next piece of what the robot says, for whoever plays it; played one after the other
   */
  sound: any;
  /** because: what was to be played is not to be heard any more */
  silence: any;
  /**
   * thing, places: it has looked there for something, in the order of the places, and has not found it
   */
  searched: any;
  /** because: it was told to stop, and everything that was in flight has ended */
  stopping: any;
  /** because: the robot has confirmed that it stands */
  stopped: any;
  /** because, message: it may still be moving, use its own button */
  stop_not_confirmed: any;
  /**
   * state (connected, lost), since (seconds since the epoch), because: whether the robot can be reached
   */
  link: any;
  /**
   * what (state | line | call | result | print), run, state, line, message, and of a call number, method, arguments, of a result also result or error and seconds, of print text
   */
  program: any;
  /**
   * what (thinking | writing), talk, utterance, microphone if it was spoken, and of writing text, the program so far: a language model is at work on a sentence; at most 10 a second. What was spoken only the microphone's client is told
   */
  translation: any;
  /**
   * sequence (rises with every change; what has a lower one is old), state (idle, reviewing, running, pausing, paused, stopping, stopped, lost, charging), since (seconds since the epoch), because, run and line of the program that goes on, unconfirmed (whether the robot has not confirmed the last stop), lost_since, charging, driven_by (who drives it by hand, or null): how the robot and its program stand. On subscribing the present one is sent
   */
  state: any;
  /**
   * open (what waits, begins or runs now, as schedule.history tells it): something in the book of appointments has changed; schedule.list tells all of it
   */
  schedule: any;
  /**
   * buttons: those that the robot's face shows now, as the method of this name lists them
   */
  'schedule.buttons': any;
  /**
   * id (null if the book of appointments cannot be written), time, kind (missed | missed_many | overtaken | waits | ends_soon | ended | changed | refused | failed | broken_off | moved | reminder_no | reminder_unclear | reminder_silent | reminder_away | reminder_gone | trouble), appointment (0: of a reminder that somebody had said at once, and of trouble), occurrence, parts, told (the sentence by language): what somebody has to know who was not looking
   */
  notice: any;
  /**
   * id, state (waiting | approved | declined | withdrawn | expired), by, sentence, why, at, and once it is decided decided_by, reason, run: a program was proposed, or one that waited is decided
   */
  proposal: any;
  /**
   * members and errands, as fleet.list tells them, when something has changed; at most five times a second
   */
  fleet: any;
  /**
   * nothing more: something of the appointments of the fleet is another, which the method of this name lists
   */
  'fleet.plans': any;
  /**
   * time, x, y (metres), theta (degrees), speed (m/s), place, way [[x, y]] ahead, lidar [centimetres], people [[name, kind, x, y, theta, posture]], things that were moved [[number, x, y, holder: name | true for the robot | null]], closed [numbers of doors], holding [names]; at most 12 a second, once `scene.floor` was called
   */
  scene: any;
  /**
   * zones, as zones.list tells them, and history, as zones.history does, whenever they were drawn anew
   */
  zones: any;
  /** places, as places.list tells them, whenever one was named or removed */
  places: any;
  /** history, as location.history tells it, whenever it was corrected */
  location: any;
  /**
   * driver (the name of a connection, or null), who, since (seconds since the epoch), asking (a list of connection and who)
   */
  helm: any;
  /**
   * version and what has changed of: language, chosen (whether a visitor has chosen it), emotion, mood (thinking | null), screen, asking (number, question, options, person, called: the options in each language, language: of the program, or null), speech, robot (the state, as of the event `state`), stopped, unconfirmed (whether the last stop was not confirmed), lost (since when the robot is, or null); as `face.state` tells all of it
   */
  face: any;
  /** number, act (click | type), selector, text: what this face is to do to its page */
  'face.act': any;
  /**
   * call, state (ringing | calling | answered | away | ended), caller (face | operator), who; offers, if answered: whether this page makes the first offer; key, if calling or answered: to come back with, as another page; because, if ended
   */
  'call.state': any;
  /** call, signal: what the other side's WebRTC connection has to say */
  'call.signal': any;
  /** nothing; whenever a routine was learned, changed or removed */
  routines: any;
}

/** Bytes. */
export type LongestFrame = 262144;

/** The kinds of events that can be subscribed to. */
export type EventName = keyof Events;

export interface CallOptions {
  /** Cancels this call: the robot stops doing it, and it ends with `Stopped`. */
  signal?: AbortSignal;
}

type Method<Row> = Row extends {params: infer Params; result: infer Result}
  ? {} extends Params
    ? (params?: Params, options?: CallOptions) => Promise<Result>
    : (params: Params, options?: CallOptions) => Promise<Result>
  : never;

/** A function for each of them: `robot.goto({place})` calls "robot.goto". */
export type Api = {
  [Group in keyof Methods]: {[Name in keyof Methods[Group]]: Method<Methods[Group][Name]>};
};
